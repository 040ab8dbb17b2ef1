// SPDX-License-Identifier: BSD-3-Clause
// Learns the pattern of SteeredBrief (bench/brief_pattern.inc): which 256 comparisons tell corners apart and
// stay the same when a corner is seen again, and agree with each other as little as possible (greedy search as in ORB,
// section 4.3, which knows no second view). Second views are made: each image is warped, blurred and given noise, and
// corners are found in both.
//   learn_brief IMAGE ... >bench/brief_pattern.inc
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "bench/steered_brief.h"
#include "slam/features/orb_extractor.h"

namespace rumi {
namespace {

constexpr int kWarps = 12;   // of each image
constexpr int kStep_px = 2;  // between candidates' places
constexpr int kBits = 256;

struct Place {
  int x = 0, y = 0;
};
using Bits = std::vector<uint64_t>;

std::vector<Place> candidate_places() {
  std::vector<Place> places;
  for (int y = -SteeredBrief::kRadius; y <= SteeredBrief::kRadius; ++y)
    for (int x = -SteeredBrief::kRadius; x <= SteeredBrief::kRadius; ++x)
      if (x % kStep_px == 0 && y % kStep_px == 0 && x * x + y * y <= SteeredBrief::kRadius * SteeredBrief::kRadius)
        places.push_back({x, y});
  return places;
}

// What the places around keypoints look like, turned to each keypoint's direction.
class Views {
 public:
  Views(const cv::Mat& grey, OrbExtractor* extractor)
      : pyramid(extractor->pyramid(grey)), features(extractor->extract(pyramid, 2000)) {
    for (int i = 0; i < pyramid.levels(); ++i) smooth_.push_back(SteeredBrief::smooth(pyramid.level(i)));
  }
  std::vector<uint8_t> look(size_t keypoint, const std::vector<Place>& places) const {
    const Keypoint& k = features.keypoints[keypoint];
    const Eigen::Vector2f at = pyramid.to_level(k.pixel, k.octave);
    const float c = std::cos(k.angle_rad), s = std::sin(k.angle_rad);
    std::vector<uint8_t> seen;
    for (const Place& p : places)
      seen.push_back(smooth_[k.octave].at<uint8_t>(
          cvRound(at.y()) + cvRound(s * static_cast<float>(p.x) + c * static_cast<float>(p.y)),
          cvRound(at.x()) + cvRound(c * static_cast<float>(p.x) - s * static_cast<float>(p.y))));
    return seen;
  }
  ImagePyramid pyramid;
  Features features;

 private:
  std::vector<cv::Mat> smooth_;
};

// The image from elsewhere, and where its pixels are then.
cv::Mat seen_from_elsewhere(const cv::Mat& grey, std::mt19937* random, cv::Matx33d* there_from_here) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(*random); };
  const double w = grey.cols, h = grey.rows, angle = uniform(-0.5, 0.5), scale = std::exp(uniform(-0.25, 0.25));
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const cv::Matx33d to_middle(1, 0, -w / 2, 0, 1, -h / 2, 0, 0, 1), back(1, 0, w / 2, 0, 1, h / 2, 0, 0, 1);
  const cv::Matx33d turn(c, -s, 0, s, c, 0, 0, 0, 1);
  const cv::Matx33d shear(1 + uniform(-.15, .15), uniform(-.15, .15), 0, 0, 1, 0, uniform(-4e-4, 4e-4),
                          uniform(-4e-4, 4e-4), 1);
  *there_from_here = back * shear * turn * to_middle;
  cv::Mat warped, noise(grey.size(), CV_32F);
  cv::warpPerspective(grey, warped, *there_from_here, grey.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const double blur = uniform(0, 1.2);
  if (blur > 0.3) cv::GaussianBlur(warped, warped, {}, blur);
  cv::RNG rng((*random)());
  rng.fill(noise, cv::RNG::NORMAL, 0, 4);
  warped.convertTo(warped, CV_32F, uniform(0.8, 1.2), uniform(-15, 15));
  warped += noise;
  warped.convertTo(warped, CV_8U);
  return warped;
}

struct Sightings {
  std::vector<std::vector<uint8_t>> first, second;  // of the same corners
};

void find_sightings(const cv::Mat& grey, const std::vector<Place>& places, std::mt19937* random, Sightings* sightings) {
  OrbExtractor extractor({});
  const std::vector<double> scales = octave_scales({});
  const Views here(grey, &extractor);
  for (int warp = 0; warp < kWarps; ++warp) {
    cv::Matx33d there_from_here;
    const Views there(seen_from_elsewhere(grey, random, &there_from_here), &extractor);
    for (size_t i = 0; i < here.features.size(); ++i) {
      const Keypoint& k = here.features.keypoints[i];
      const cv::Vec3d p = there_from_here * cv::Vec3d(k.pixel.x(), k.pixel.y(), 1);
      const Eigen::Vector2f at(static_cast<float>(p[0] / p[2]), static_cast<float>(p[1] / p[2]));
      for (size_t j = 0; j < there.features.size(); ++j) {
        const Keypoint& other = there.features.keypoints[j];
        if (std::abs(k.octave - other.octave) > 1 || (other.pixel - at).norm() > 1.5 * scales[other.octave]) continue;
        sightings->first.push_back(here.look(i, places));
        sightings->second.push_back(there.look(j, places));
        break;
      }
    }
  }
}

Bits compare(const std::vector<std::vector<uint8_t>>& views, size_t a, size_t b) {
  Bits bits((views.size() + 63) / 64, 0);
  for (size_t i = 0; i < views.size(); ++i)
    if (views[i][a] < views[i][b]) bits[i / 64] |= uint64_t{1} << (i % 64);
  return bits;
}

template <class Combine>
double share(const Bits& a, const Bits& b, size_t n, Combine combine) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += std::popcount(combine(a[i], b[i]));
  return static_cast<double>(count) / static_cast<double>(n);
}

struct Test {
  size_t a = 0, b = 0;
  Bits bits;
  double mean = 0, flips = 0;
  double worth() const { return 2 * mean * (1 - mean) - flips; }  // differs between corners, not between views of one
};

std::vector<Test> learn(const Sightings& sightings, size_t places) {
  const size_t n = sightings.first.size();
  std::vector<Test> tests;
  for (size_t a = 0; a < places; ++a)
    for (size_t b = a + 1; b < places; ++b) {
      Test test{a, b, compare(sightings.first, a, b)};
      test.mean = share(test.bits, test.bits, n, [](uint64_t x, uint64_t) { return x; });
      test.flips = share(test.bits, compare(sightings.second, a, b), n, [](uint64_t x, uint64_t y) { return x ^ y; });
      if (test.worth() > 0.1) tests.push_back(std::move(test));
    }
  std::stable_sort(tests.begin(), tests.end(), [](const Test& x, const Test& y) { return x.worth() > y.worth(); });
  fmt::print(stderr, "{} corners seen twice, {} tests, worth up to {:.3f}\n", n, tests.size(), tests.front().worth());
  for (double most = 0.2; most < 1; most += 0.02) {
    std::vector<Test> chosen;
    for (const Test& test : tests) {
      const auto is_alike = [&](const Test& other) {
        const double both = share(test.bits, other.bits, n, [](uint64_t x, uint64_t y) { return x & y; });
        const double spread = std::sqrt(test.mean * (1 - test.mean) * other.mean * (1 - other.mean));
        return std::abs(both - test.mean * other.mean) > most * spread;
      };
      if (std::none_of(chosen.begin(), chosen.end(), is_alike)) chosen.push_back(test);
      if (chosen.size() == kBits) break;
    }
    fmt::print(stderr, "correlation up to {:.2f}: {} tests\n", most, chosen.size());
    if (chosen.size() == kBits) return chosen;
  }
  return {};
}

int main_of(int argc, char** argv) {
  std::mt19937 random(1);
  const std::vector<Place> places = candidate_places();
  Sightings sightings;
  for (int i = 1; i < argc; ++i) {
    const cv::Mat grey = cv::imread(argv[i], cv::IMREAD_GRAYSCALE);
    if (grey.empty()) {
      fmt::print(stderr, "cannot read {}\n", argv[i]);
      return 1;
    }
    find_sightings(grey, places, &random, &sightings);
  }
  if (sightings.first.empty()) {
    fmt::print(stderr, "usage: learn_brief IMAGE ...\n");
    return 2;
  }
  const std::vector<Test> tests = learn(sightings, places.size());
  fmt::print("// SPDX-License-Identifier: BSD-3-Clause\n");
  fmt::print(
      "// Comparisons {{x1, y1, x2, y2}} in pixels from the keypoint, the best first: by learn_brief, of {} corners\n",
      sightings.first.size());
  fmt::print("// seen twice in {} images.\n", argc - 1);
  double flips = 0;
  for (size_t i = 0; i < tests.size(); ++i) {
    const Place a = places[tests[i].a], b = places[tests[i].b];
    fmt::print("{{{}, {}, {}, {}}},{}", a.x, a.y, b.x, b.y, i % 6 == 5 ? '\n' : ' ');
    flips += tests[i].flips / static_cast<double>(tests.size());
  }
  fmt::print(stderr, "a bit flips between views with {:.3f}\n", flips);
  return tests.size() == kBits ? 0 : 1;
}

}  // namespace
}  // namespace rumi

int main(int argc, char** argv) { return rumi::main_of(argc, argv); }
