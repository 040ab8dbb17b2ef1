// SPDX-License-Identifier: BSD-3-Clause
// Paints roads, pavements and lawns, whose pictures fit to themselves on all sides.
#include <cmath>
#include <initializer_list>
#include <opencv2/imgproc.hpp>

#include "synth/street_pictures.h"

namespace rumi::synth {
namespace {

constexpr int kSize = TextureAtlas::kSize;

int px(double metres) { return static_cast<int>(std::lround(metres * kGroundPxPerM)); }

cv::Mat bytes(int size, cv::RNG& rng) {
  cv::Mat out(size, size, CV_8U);
  rng.fill(out, cv::RNG::UNIFORM, 0, 256);
  return out;
}

// Returns smooth noise around 128 with cells of `cell_px`, a power of two, that fits to itself on all sides.
cv::Mat smooth(int cell_px, int size, cv::RNG& rng) {
  constexpr int kAround = 4;  // cells
  cv::Mat coarse = bytes(size / cell_px, rng), padded, fine;
  if (cell_px == 1) return coarse;
  cv::copyMakeBorder(coarse, padded, kAround, kAround, kAround, kAround, cv::BORDER_WRAP);
  cv::resize(padded, fine, {}, cell_px, cell_px, cv::INTER_CUBIC);
  return fine(cv::Rect(kAround * cell_px, kAround * cell_px, size, size));
}

struct Octave {
  int cell_px;  // 4 or more
  double strength;
};

// Adds noise of several octaves to the image, of which those with wide cells are made from a smaller picture.
void add_noise(cv::Mat& image, std::initializer_list<Octave> coarse, double fine_strength, cv::RNG& rng) {
  constexpr int kShrink = 4;
  cv::Mat sum(kSize / kShrink, kSize / kShrink, CV_8U, cv::Scalar(128)), large;
  for (const Octave& octave : coarse)
    cv::addWeighted(sum, 1, smooth(octave.cell_px / kShrink, sum.cols, rng), octave.strength, -128 * octave.strength,
                    sum);
  cv::resize(sum, large, image.size(), 0, 0, cv::INTER_LINEAR);
  cv::addWeighted(image, 1, large, 1, -128, image);
  rng.fill(large, cv::RNG::UNIFORM, 0, 256);
  cv::boxFilter(large, large, -1, {2, 2});
  cv::addWeighted(image, 1, large, fine_strength, -128 * fine_strength, image);
}

// Draws with `draw(shift)` as often as needed for what reaches over an edge to come in from the other side.
template <class F>
void wrapped(cv::Point at, int radius, const F& draw) {
  if (at.x >= radius && at.y >= radius && at.x < kSize - radius && at.y < kSize - radius) return draw(cv::Point(0, 0));
  for (const int dx : {-kSize, 0, kSize})
    for (const int dy : {-kSize, 0, kSize}) {
      const cv::Rect bounds(at.x + dx - radius, at.y + dy - radius, 2 * radius, 2 * radius);
      if ((bounds & cv::Rect(0, 0, kSize, kSize)).area() > 0) draw(cv::Point(dx, dy));
    }
}

cv::Point somewhere(cv::RNG& rng) { return {rng.uniform(0, kSize), rng.uniform(0, kSize)}; }

void specks(cv::Mat& image, int count, int most_px, int low, int high, cv::RNG& rng) {
  for (int i = 0; i < count; ++i) {
    const cv::Point at = somewhere(rng);
    const int radius = rng.uniform(1, most_px + 1), ink = rng.uniform(low, high);
    wrapped(at, radius + 1, [&](cv::Point shift) { cv::circle(image, at + shift, radius, ink, cv::FILLED); });
  }
}

void cracks(cv::Mat& image, int count, double length_m, int ink, cv::RNG& rng) {
  for (int i = 0; i < count; ++i) {
    const cv::Point at = somewhere(rng);
    std::vector<cv::Point> line{at};
    double heading = rng.uniform(0.0, 2 * CV_PI);
    const int steps = rng.uniform(10, 40), width = rng.uniform(1, 4);
    for (int k = 0; k < steps; ++k) {
      heading += rng.uniform(-0.7, 0.7);
      const double step = length_m * kGroundPxPerM / steps;
      line.push_back(line.back() +
                     cv::Point(static_cast<int>(step * std::cos(heading)), static_cast<int>(step * std::sin(heading))));
    }
    wrapped(at, px(length_m), [&](cv::Point shift) {
      std::vector<cv::Point> there;
      there.reserve(line.size());
      for (const cv::Point& p : line) there.push_back(p + shift);
      cv::polylines(image, there, false, ink, width, cv::LINE_AA);
    });
  }
}

// Where the asphalt was mended: rectangles of another shade with a seam.
void mend(cv::Mat& tone, int count, cv::RNG& rng) {
  for (int i = 0; i < count; ++i) {
    const cv::Point at = somewhere(rng);
    const cv::Size2f size(rng.uniform(50.f, 300.f), rng.uniform(40.f, 160.f));
    const float turn = rng.uniform(-6.f, 6.f) + 90.f * static_cast<float>(rng.uniform(0, 2));
    const int ink = rng.uniform(55, 150), seam = rng.uniform(20, 70);
    wrapped(at, px(3.6), [&](cv::Point shift) {
      cv::Point2f corners[4];
      cv::RotatedRect(at + shift, size, turn).points(corners);
      const std::vector<cv::Point> polygon(corners, corners + 4);
      cv::fillConvexPoly(tone, polygon, ink, cv::LINE_AA);
      cv::polylines(tone, polygon, true, seam, 3, cv::LINE_AA);
    });
  }
}

}  // namespace

cv::Mat paint_asphalt(cv::RNG& rng) {
  cv::Mat tone(kSize, kSize, CV_8U, cv::Scalar(112));
  mend(tone, 90, rng);
  add_noise(tone, {{512, 0.16}, {64, 0.16}, {16, 0.15}, {4, 0.16}}, 0.3, rng);
  specks(tone, 9000, 3, 150, 230, rng);
  specks(tone, 9000, 4, 20, 70, rng);
  specks(tone, 700, 14, 40, 90, rng);
  cracks(tone, 260, 2.5, 25, rng);
  cracks(tone, 500, 0.6, 35, rng);
  return both(tone, cv::Mat::zeros(tone.size(), CV_8U));
}

cv::Mat paint_paving(cv::RNG& rng) {
  cv::Mat tone(kSize, kSize, CV_8U, cv::Scalar(60)), accent = cv::Mat::zeros(kSize, kSize, CV_8U);
  constexpr int kRow = 32, kSlab = 64;
  for (int row = 0; row * kRow < kSize; ++row)
    for (int k = 0; k * kSlab < kSize; ++k) {
      // Every other row is half a slab farther, and its last slab comes in again from the left.
      const int left = k * kSlab + (row % 2) * kSlab / 2 + rng.uniform(0, 3);
      const int ink = rng.uniform(0, 12) ? rng.uniform(110, 205) : rng.uniform(70, 240);
      for (const int shift : {0, -kSize})
        cv::rectangle(tone, cv::Rect(left + shift, row * kRow + 1, kSlab - rng.uniform(3, 5), kRow - 3), ink,
                      cv::FILLED);
    }
  add_noise(tone, {{256, 0.22}, {32, 0.14}, {4, 0.1}}, 0.22, rng);
  specks(tone, 7000, 4, 30, 90, rng);
  specks(tone, 1500, 7, 190, 250, rng);
  specks(accent, 2500, 7, 120, 240, rng);
  cracks(tone, 300, 0.8, 40, rng);
  return both(tone, accent);
}

cv::Mat paint_lawn(cv::RNG& rng) {
  cv::Mat tone(kSize, kSize, CV_8U, cv::Scalar(120));
  add_noise(tone, {{512, 0.25}, {64, 0.22}, {16, 0.22}, {8, 0.28}}, 0.6, rng);
  cv::Mat accent(tone.size(), CV_8U, cv::Scalar(0));
  add_noise(accent, {{128, 1.0}}, 0, rng);
  specks(accent, 9000, 5, 150, 255, rng);
  specks(tone, 6000, 5, 190, 255, rng);
  specks(tone, 9000, 6, 20, 80, rng);
  return both(tone, accent);
}

}  // namespace rumi::synth
