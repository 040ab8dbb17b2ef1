// SPDX-License-Identifier: BSD-3-Clause
// Paints the sides and ends of cars and of a lorry.
#include <opencv2/imgproc.hpp>

#include "synth/street_pictures.h"

namespace rumi::synth {
namespace {

cv::Vec3b shifted(cv::Vec3b colour, int amount, cv::RNG& rng) {
  for (int k = 0; k < 3; ++k) colour[k] = cv::saturate_cast<uchar>(colour[k] + rng.uniform(-amount, amount + 1));
  return colour;
}

}  // namespace

CarShape car_shape(int kind) {
  CarShape s;
  s.half_width_m = 0.87;
  switch (kind) {
    case 1:
      s.outline = {{-2.2, .35}, {-2.22, .72}, {-2.15, .95}, {-1.55, 1.0}, {-1.0, 1.38}, {.1, 1.42},
                   {.5, 1.38},  {1.15, .95},  {2.0, .82},   {2.2, .62},   {2.22, .3}};
      s.axles_m[0] = -1.32;
      s.axles_m[1] = 1.4;
      break;
    case 2:
      s.outline = {{-2.3, .35}, {-2.32, .9}, {-2.28, 1.9}, {-2.1, 2.0}, {.9, 2.0},
                   {1.1, 1.9},  {1.6, 1.15}, {2.2, .95},   {2.3, .7},   {2.3, .3}};
      s.axles_m[0] = -1.45;
      s.axles_m[1] = 1.5;
      s.half_width_m = 0.93;
      break;
    case 3:
      s.outline = {{-2.2, .35}, {-2.24, .8}, {-2.18, 1.0}, {-1.85, 1.4}, {-1.4, 1.47}, {.1, 1.47},
                   {.5, 1.42},  {1.15, .97}, {2.0, .84},   {2.2, .62},   {2.22, .3}};
      s.axles_m[0] = -1.32;
      s.axles_m[1] = 1.4;
      break;
    default:
      s.outline = {{-1.9, .35}, {-1.95, .8}, {-1.86, 1.02}, {-1.55, 1.42}, {-.9, 1.5}, {.1, 1.5},
                   {.45, 1.43}, {1.1, 1.0},  {1.75, .86},   {1.95, .62},   {1.95, .3}};
      s.axles_m[0] = -1.2;
      s.axles_m[1] = 1.25;
  }
  s.length_m = s.outline.back().x - s.outline.front().x + 0.1;
  s.height_m = 0;
  for (const cv::Point2d& p : s.outline) s.height_m = std::max(s.height_m, p.y);
  return s;
}

constexpr double kBelt_m = 0.93;  // height of a car's windows

// `at` returns the pixel of a point of the side: x and z in metres.
template <class At>
void paint_car_windows(const CarShape& shape, const At& at, cv::Mat& tone, cv::Mat& accent, cv::RNG& rng) {
  // Windows follow the outline at a distance above the belt.
  std::vector<cv::Point> glass;
  double first = 9, last = -9;
  for (const cv::Point2d& p : shape.outline)
    if (p.y > kBelt_m + 0.2) {
      glass.push_back(at(0.93 * p.x, p.y - 0.09));
      first = std::min(first, p.x);
      last = std::max(last, p.x);
    }
  const double rear_window = shape.height_m > 1.8 ? 0.35 : first - 0.15;
  if (shape.height_m > 1.8) {  // the load of a van has no windows
    glass = {at(rear_window, shape.height_m - 0.2), at(last - 0.15, shape.height_m - 0.25)};
    cv::rectangle(accent, at(-2.3, 1.3), at(0.2, 1.1), rng.uniform(80, 255), cv::FILLED);
    for (int i = 0; i < 7; ++i) {
      const double x = rng.uniform(-2.0, 0.1), z = rng.uniform(1.0, 1.7), r = rng.uniform(0.05, 0.25);
      cv::circle(i % 2 ? tone : accent, at(x, z), static_cast<int>(r * kCarPxPerM), rng.uniform(0, 255),
                 i % 3 ? cv::FILLED : 3);
    }
  }
  glass.push_back(at(last + 0.32, kBelt_m));
  glass.push_back(at(rear_window, kBelt_m));
  cv::fillPoly(tone, std::vector<std::vector<cv::Point>>{glass}, 28, cv::LINE_AA);
  cv::line(tone, at(rear_window + .2, kBelt_m + .05), at(rear_window + .6, kBelt_m + .4), 120, 3, cv::LINE_AA);
}

// The picture spans the car's length from rear (left) to front, and from its top to the ground.
cv::Mat paint_car_side(const CarShape& shape, cv::RNG& rng) {
  const double k = kCarPxPerM;
  const cv::Size size(static_cast<int>(shape.length_m * k), static_cast<int>(shape.height_m * k));
  cv::Mat tone(size, CV_8U, cv::Scalar(190)), accent = cv::Mat::zeros(size, CV_8U);
  const auto at = [&](double x, double z) {
    return cv::Point(static_cast<int>((x + shape.length_m / 2) * k), static_cast<int>((shape.height_m - z) * k));
  };
  for (int y = 0; y < size.height; ++y) tone.row(y).setTo(225 - static_cast<int>(120 * y / size.height));
  cv::rectangle(tone, at(-3, .36), at(3, .2), 25, cv::FILLED);
  cv::line(tone, at(-3, .62), at(3, .62), 70, 2);
  paint_car_windows(shape, at, tone, accent, rng);
  for (const double x : {-0.75, 0.15, 1.0}) {
    cv::line(tone, at(x, 0.4), at(x, kBelt_m), 50, 2, cv::LINE_AA);
    if (x < 1 && shape.height_m < 1.8) cv::line(tone, at(x, kBelt_m), at(x - .05, 1.5), 60, 6, cv::LINE_AA);
    cv::rectangle(tone, at(x - 0.22, 0.84), at(x - 0.06, 0.8), 245, cv::FILLED);
  }
  for (const double x : shape.axles_m)
    cv::circle(tone, at(x, 0.32), static_cast<int>(0.37 * k), 12, cv::FILLED, cv::LINE_AA);
  cv::rectangle(accent, at(-shape.length_m / 2, .95), at(-shape.length_m / 2 + .16, .72), 255,
                cv::FILLED);  // rear light
  cv::rectangle(tone, at(shape.length_m / 2 - .3, .78), at(shape.length_m / 2, .64), 250, cv::FILLED);
  return both(tone, accent);
}

cv::Mat paint_car_end(bool rear, cv::RNG& rng) {
  const cv::Size size(156, 64);
  cv::Mat tone(size, CV_8U), accent = cv::Mat::zeros(size, CV_8U);
  for (int y = 0; y < size.height; ++y) tone.row(y).setTo(200 - static_cast<int>(90 * y / size.height));
  for (const int x : {4, size.width - 34}) {
    cv::rectangle(tone, cv::Rect(x, 6, 30, 18), rear ? 140 : 255, cv::FILLED);
    if (rear) cv::rectangle(accent, cv::Rect(x, 6, 30, 18), 255, cv::FILLED);
    cv::rectangle(tone, cv::Rect(x, 6, 30, 18), 40, 2);
  }
  if (!rear)
    for (int y = 8; y < 26; y += 5) cv::line(tone, {42, y}, {size.width - 42, y}, 20, 3);
  cv::rectangle(tone, cv::Rect(54, 32, 48, 13), 250, cv::FILLED);  // plate
  draw_text_line(tone, 56, 100, 43, 10, 10, rng);
  cv::rectangle(tone, cv::Rect(0, 50, size.width, 14), 30, cv::FILLED);
  cv::line(tone, {0, 29}, {size.width, 29}, 70, 1);
  return both(tone, accent);
}

cv::Mat paint_glass(cv::RNG& rng) {
  const cv::Size size(120, 64);
  cv::Mat tone(size, CV_8U, cv::Scalar(34)), accent = cv::Mat::zeros(size, CV_8U);
  for (int i = 0; i < 5; ++i) {
    const int x = rng.uniform(0, size.width);
    cv::line(tone, {x, 0}, {x + rng.uniform(-40, 40), size.height}, rng.uniform(50, 130), rng.uniform(2, 9),
             cv::LINE_AA);
  }
  for (const int x : {size.width / 4, size.width * 3 / 4})
    cv::ellipse(tone, {x, size.height}, {14, 26}, 0, 0, 360, 12, cv::FILLED);
  cv::rectangle(tone, cv::Rect({}, size), 15, 3);
  return both(tone, accent);
}

cv::Mat paint_wheel(cv::RNG& rng) {
  constexpr int kSide = 64;
  cv::Mat tone(kSide, kSide, CV_8U, cv::Scalar(20)), accent = cv::Mat::zeros(kSide, kSide, CV_8U);
  cv::circle(tone, {32, 32}, 21, 190, cv::FILLED, cv::LINE_AA);
  const int spokes = rng.uniform(5, 9);
  for (int i = 0; i < spokes; ++i) {
    const double a = 2 * CV_PI * i / spokes;
    cv::circle(tone, {32 + static_cast<int>(14 * std::cos(a)), 32 + static_cast<int>(14 * std::sin(a))}, 4, 40,
               cv::FILLED, cv::LINE_AA);
  }
  return both(tone, accent);
}

Palette car_palette(cv::RNG& rng) {
  static const cv::Vec3b kPaints[] = {{235, 235, 236}, {60, 62, 68},    {150, 154, 160}, {190, 40, 36}, {40, 70, 140},
                                      {30, 32, 36},    {210, 206, 190}, {70, 110, 80},   {120, 40, 50}, {200, 150, 40}};
  return {{12, 13, 15}, shifted(kPaints[rng.uniform(0, 10)], 12, rng), {200, 30, 24}};
}

cv::Mat paint_lorry(cv::Size2d size_m, bool back, cv::RNG& rng) {
  constexpr double kPxPerM = 120;
  const cv::Size size(static_cast<int>(size_m.width * kPxPerM), static_cast<int>(size_m.height * kPxPerM));
  cv::Mat tone(size, CV_8U, cv::Scalar(215)), accent = cv::Mat::zeros(size, CV_8U);
  const int panel = static_cast<int>((back ? size_m.width / 2 : 1.2) * kPxPerM);
  for (int x = 0; x < size.width; x += panel) cv::line(tone, {x, 0}, {x, size.height}, 90, 4);
  const int stripe = size.height / 3;
  cv::rectangle(accent, cv::Rect(0, stripe, size.width, stripe / 2), 255, cv::FILLED);
  for (int k = 0; k < 3; ++k)
    draw_text_line(tone, size.width / 12, size.width * 11 / 12, size.height / 4 + k * size.height / 5,
                   size.height / (back ? 12 : 8), 25, rng);
  cv::rectangle(tone, cv::Rect(0, size.height * 9 / 10, size.width, size.height / 10), 40, cv::FILLED);
  if (back)
    for (const double x : {0.08, 0.8})
      cv::rectangle(accent,
                    cv::Rect(static_cast<int>(x * size.width), size.height * 37 / 40, size.width / 8, size.height / 20),
                    255, cv::FILLED);
  for (int i = 0; i < 260; ++i)  // rivets and dirt
    cv::circle(tone, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(1, 5), rng.uniform(60, 200),
               cv::FILLED, cv::LINE_AA);
  cv::rectangle(tone, cv::Rect({}, size), 50, 10);
  return both(tone, accent);
}

}  // namespace rumi::synth
