// SPDX-License-Identifier: BSD-3-Clause
#include "bench/steered_brief.h"

#include <cmath>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <vector>

namespace rumi {
namespace {

constexpr int kDirections = 64;
constexpr int kBits = 256;
constexpr int kBox = 5;    // pixels that are averaged, each way
constexpr int kSide = 40;  // of the patch that is looked at; its middle is (kReach, kReach)
constexpr int kReach = SteeredBrief::kRadius;
constexpr int kLanes = cv::v_uint16x8::nlanes;
static_assert(2 * kReach + 1 <= kSide);

struct Comparison {
  int8_t x1, y1, x2, y2;
};
constexpr std::array<Comparison, kBits> kPattern = {{
#include "bench/brief_pattern.inc"
}};

// Where the pattern's places are in the patch.
struct TurnedPattern {
  std::array<uint16_t, kBits> first{}, second{};
};

const std::array<TurnedPattern, kDirections>& turned_patterns() {
  static const std::array<TurnedPattern, kDirections> patterns = [] {
    std::array<TurnedPattern, kDirections> turned;
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 2 * M_PI * d / kDirections, c = std::cos(angle), s = std::sin(angle);
      const auto place = [&](int x, int y) {
        const auto column = std::lround(c * x - s * y) + kReach, row = std::lround(s * x + c * y) + kReach;
        return static_cast<uint16_t>(row * kSide + column);
      };
      for (int i = 0; i < kBits; ++i) {
        turned[d].first[i] = place(kPattern[i].x1, kPattern[i].y1);
        turned[d].second[i] = place(kPattern[i].x2, kPattern[i].y2);
      }
    }
    return turned;
  }();
  return patterns;
}

const TurnedPattern& turned_pattern(float angle_rad) {
  const auto direction = std::lround(angle_rad * static_cast<float>(kDirections / (2 * M_PI)));
  return turned_patterns()[static_cast<size_t>(direction + kDirections) % kDirections];
}

}  // namespace

cv::Mat SteeredBrief::smooth(const cv::Mat& image) {
  cv::Mat smooth = cv::Mat::zeros(image.size(), CV_8U);
  const int width = image.cols;
  if (width < 2 * kLanes || image.rows < kBox) return smooth;
  std::vector<uint16_t> columns(width);
  // The last vector of a row overlaps the one before it.
  const auto for_each_vector = [](int end, auto&& work) {
    for (int x = 0; x + kLanes <= end; x += kLanes) work(x);
    work(end - kLanes);
  };
  const cv::v_uint16x8 half = cv::v_setall_u16(kBox * kBox / 2), share = cv::v_setall_u16(65536 / (kBox * kBox) + 1);
  for (int y = 0; y + kBox <= image.rows; ++y) {
    const uint8_t* above = image.ptr<uint8_t>(y);
    const auto stride = static_cast<std::ptrdiff_t>(image.step1());
    for_each_vector(width, [&](int x) {
      const auto row = [&](int i) { return cv::v_load_expand(above + i * stride + x); };
      cv::v_store(&columns[x], row(0) + row(1) + row(2) + row(3) + row(4));
    });
    uint8_t* out = smooth.ptr<uint8_t>(y + kBox / 2) + kBox / 2;
    for_each_vector(width - kBox + 1, [&](int x) {
      const auto column = [&](int i) { return cv::v_load(&columns[x + i]); };
      const cv::v_uint16x8 sum = column(0) + column(1) + column(2) + column(3) + column(4);
      cv::v_pack_store(out + x, cv::v_mul_hi(sum + half, share));
    });
  }
  return smooth;
}

Descriptor SteeredBrief::describe(const cv::Mat& smooth, const cv::Point2f& at, float angle_rad) {
  // Together in memory, whatever the image's width: one table of places does.
  std::array<uint8_t, static_cast<size_t>(kSide) * kSide> patch;
  for (int row = 0; row <= 2 * kReach; ++row)
    std::memcpy(&patch[static_cast<size_t>(row) * kSide],
                smooth.ptr<uint8_t>(cvRound(at.y) - kReach + row) + cvRound(at.x) - kReach, 2 * kReach + 1);
  const TurnedPattern& pattern = turned_pattern(angle_rad);
  std::array<uint8_t, kBits> first, second;
  for (int i = 0; i < kBits; ++i) {
    first[i] = patch[pattern.first[i]];
    second[i] = patch[pattern.second[i]];
  }
  Descriptor descriptor{};
  for (int i = 0; i < kBits; i += cv::v_uint8x16::nlanes) {
    const auto bits = static_cast<uint64_t>(cv::v_signmask(cv::v_load(&first[i]) < cv::v_load(&second[i])));
    descriptor[i / 64] |= bits << (i % 64);
  }
  return descriptor;
}

}  // namespace rumi
