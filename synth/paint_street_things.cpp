// SPDX-License-Identifier: BSD-3-Clause
// Paints leaves, fences, signs, what lies on the road, and the sky.
#include <opencv2/imgproc.hpp>

#include "synth/street_pictures.h"

namespace rumi::synth {
namespace {

void draw_leaf(cv::Mat& tone, cv::Point at, int ink, cv::RNG& rng, cv::Mat* hole) {
  const cv::Size axes(rng.uniform(6, 13), rng.uniform(3, 7));
  const double turn = rng.uniform(0, 180);
  cv::ellipse(tone, at, axes, turn, 0, 360, ink, cv::FILLED, cv::LINE_AA);
  if (hole) cv::ellipse(*hole, at, axes, turn, 0, 360, 0, cv::FILLED);
}

}  // namespace

cv::Mat paint_leaves(cv::RNG& rng) {
  constexpr int kSide = 224;
  cv::Mat tone(kSide, kSide, CV_8U, cv::Scalar(70)), hole(kSide, kSide, CV_8U, cv::Scalar(255));
  for (int i = 0; i < 330; ++i) {
    // Leaves crowd in the middle, so that the picture has no straight edge.
    const double r = kSide * 0.46 * std::sqrt(rng.uniform(0.0, 1.0)) * rng.uniform(0.6, 1.0);
    const double angle = rng.uniform(0.0, 2 * CV_PI);
    const cv::Point at(static_cast<int>(kSide * 0.5 + r * std::cos(angle)),
                       static_cast<int>(kSide * 0.5 + r * std::sin(angle)));
    // Those drawn first lie deepest in the shade.
    draw_leaf(tone, at, 20 + i * 150 / 330 + rng.uniform(0, 85), rng, &hole);
  }
  return both(tone, hole);
}

cv::Mat paint_fence(cv::RNG& rng) {
  const cv::Size size(160, 96);  // 2 m by 1.2 m
  cv::Mat tone(size, CV_8U, cv::Scalar(120)), hole(size, CV_8U, cv::Scalar(255));
  const int pitch = rng.uniform(9, 17), wide = rng.uniform(3, pitch - 3);
  for (const int y : {18, 70}) {
    cv::rectangle(tone, cv::Rect(0, y, size.width, 6), 90, cv::FILLED);
    cv::rectangle(hole, cv::Rect(0, y, size.width, 6), 0, cv::FILLED);
  }
  for (int x = rng.uniform(0, pitch); x < size.width; x += pitch) {
    const cv::Rect slat(x, rng.uniform(0, 8), wide, size.height);
    cv::rectangle(tone, slat, rng.uniform(130, 250), cv::FILLED);
    cv::rectangle(hole, slat, 0, cv::FILLED);
  }
  add_noise(tone, octave_noise(size, rng, 12), 22);
  return both(tone, hole);
}

cv::Mat paint_hedge(cv::RNG& rng) {
  const cv::Size size(320, 200);  // 2 m by 1.25 m
  cv::Mat tone(size, CV_8U, cv::Scalar(40)), accent = cv::Mat::zeros(size, CV_8U);
  for (int i = 0; i < 1500; ++i)
    draw_leaf(tone, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(20, 90) + i / 12, rng,
              nullptr);
  for (int i = rng.uniform(0, 40); i > 0; --i)
    cv::circle(accent, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(2, 5), 255, cv::FILLED);
  return both(tone, accent);
}

cv::Mat paint_sign(cv::RNG& rng) {
  constexpr int kSide = 96;
  cv::Mat tone(kSide, kSide, CV_8U, cv::Scalar(245)), accent = cv::Mat::zeros(kSide, kSide, CV_8U);
  const int kind = rng.uniform(0, 3);
  cv::rectangle(accent, {0, 0, kSide, kSide}, 255, kind == 0 ? cv::FILLED : 12);
  if (kind == 0) cv::circle(accent, {kSide / 2, kSide / 2}, 36, 0, cv::FILLED, cv::LINE_AA);
  if (kind == 1) cv::line(accent, {8, 88}, {88, 8}, 255, 10, cv::LINE_AA);
  const std::vector<cv::Point> arrow = {{30, 78}, {30, 44}, {18, 44}, {42, 18}, {66, 44}, {54, 44}, {54, 78}};
  if (kind != 1) cv::fillPoly(tone, std::vector<std::vector<cv::Point>>{arrow}, 10, cv::LINE_AA);
  for (int k = 0; k < 2; ++k) draw_text_line(tone, 14, 84, 40 + 36 * k, 15, 5, rng);
  return both(tone, accent);
}

cv::Mat paint_manhole(cv::RNG& rng) {
  constexpr int kSide = 120;
  cv::Mat tone(kSide, kSide, CV_8U, cv::Scalar(95)), hole(kSide, kSide, CV_8U, cv::Scalar(255));
  const cv::Point middle(kSide / 2, kSide / 2);
  cv::circle(hole, middle, 58, 0, cv::FILLED);
  cv::circle(tone, middle, 54, 30, 4, cv::LINE_AA);
  const int pitch = rng.uniform(10, 20);
  for (int y = 14; y < kSide - 10; y += pitch)
    for (int x = 14; x < kSide - 10; x += pitch) {
      if (cv::norm(cv::Point(x + 3, y + 3) - middle) > 44) continue;
      cv::rectangle(tone, cv::Rect(x, y, pitch - 5, pitch - rng.uniform(5, 8)), rng.uniform(120, 190), cv::FILLED);
    }
  draw_text_line(tone, 30, 90, 66, 14, 20, rng);
  return both(tone, hole);
}

cv::Mat paint_patch_of_tar(cv::RNG& rng) {
  const cv::Size size(200, 140);
  cv::Mat tone(size, CV_8U, cv::Scalar(rng.uniform(40, 130))), hole = cv::Mat::zeros(size, CV_8U);
  add_noise(tone, octave_noise(size, rng, 40, 0.8), 20);
  for (int i = 0; i < 240; ++i)
    cv::circle(tone, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(1, 4), rng.uniform(20, 200),
               cv::FILLED, cv::LINE_AA);
  for (int i = 0; i < 4; ++i)
    cv::line(tone, {rng.uniform(0, size.width), rng.uniform(0, size.height)},
             {rng.uniform(0, size.width), rng.uniform(0, size.height)}, 25, rng.uniform(1, 3), cv::LINE_AA);
  cv::rectangle(tone, cv::Rect({}, size), 20, 5);
  return both(tone, hole);
}

cv::Mat paint_marking(cv::RNG& rng) {
  const cv::Size size(200, 24);
  cv::Mat tone(size, CV_8U, cv::Scalar(225)), hole;
  add_noise(tone, octave_noise(size, rng, 16, 0.8), 20);
  const cv::Mat worn = octave_noise(size, rng, 14, 0.75) - 1.0;
  worn.convertTo(hole, CV_8U, 900);
  return both(tone, hole);
}

cv::Mat paint_sky(double clouds, cv::RNG& rng) {
  const cv::Size size(2400, 600);
  cv::Mat noise = octave_noise(size, rng, 108, 0.58, 2.2), tone(size, CV_8U), accent = cv::Mat::zeros(size, CV_8U);
  // The right end fades into what begins on the left.
  constexpr int kSeam = 240;
  const cv::Mat begin = octave_noise({kSeam, size.height}, rng, 108, 0.58, 2.2);
  const cv::Mat ridge = octave_noise({size.width, 1}, rng, 300, 0.55),
                wood = octave_noise({size.width, 1}, rng, 10, 0.8);
  for (int x = 0; x < size.width; ++x) {
    const double in = std::min(1.0, std::min(x, size.width - 1 - x) / static_cast<double>(kSeam));
    for (int y = 0; y < size.height; ++y) {
      const double up = 1 - y / (size.height - 1.0);  // 0 at the horizon
      const double n = in * noise.at<float>(y, x) + (1 - in) * begin.at<float>(y, kSeam / 2);
      const double cloud = std::clamp((n - 0.9 + 1.9 * clouds) * 1.6, 0.0, 1.0);
      const double haze = std::exp(-up * 7);
      tone.at<uchar>(y, x) = cv::saturate_cast<uchar>(90 * (1 - up) + 130 * haze + cloud * (95 + 45 * n));
    }
    const double hill = in * ridge.at<float>(0, x) * 0.5 + 0.45;
    const int top = static_cast<int>(size.height * (0.952 - 0.045 * hill - 0.004 * wood.at<float>(0, x)));
    for (int y = std::max(0, top); y < size.height; ++y) {
      accent.at<uchar>(y, x) = 255;
      tone.at<uchar>(y, x) = 30;
    }
  }
  return both(tone, accent);
}

}  // namespace rumi::synth
