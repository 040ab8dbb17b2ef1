// SPDX-License-Identifier: BSD-3-Clause
// Paints the surfaces of the room. Every object gets a picture of its own, because repeated ones would mislead SLAM.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>

namespace rumi::synth {

enum class Material {
  // walls
  kBrick,
  kPlaster,
  kWallpaper,
  kPanelling,
  kStone,
  // floors and ceilings
  kPlanks,
  kTiles,
  kCarpet,
  kCeiling,
  // things
  kWood,
  kCloth,
  kCardboard,
  kBook,
  kPoster,
  kPicture,
  kScreen,
  kWindow,
  kLeaf,
  kPot,
  kPaper,
};

// A painted picture has two channels. Tone leads from `dark` to `light`, and the accent channel from that colour to
// `accent`.
struct Palette {
  cv::Vec3b dark, light, accent;  // R, G, B
};

// Returns CV_8UC2 of `size` pixels, with px_per_m pixels per metre.
cv::Mat paint(Material material, cv::Size size, double px_per_m, cv::RNG& rng);
Palette random_palette(Material material, cv::RNG& rng);

// A canvas of one material, which the functions below draw on. It has the two channels of a painted picture.
struct Canvas {
  cv::Mat tone, accent;  // CV_8UC1
  double px_per_m;
  cv::RNG& rng;

  int px(double metres) const { return std::max(1, static_cast<int>(std::floor(metres * px_per_m + 0.5))); }
  cv::Size size() const { return tone.size(); }
};
// Returns a painted picture of these channels (CV_8UC1 each).
cv::Mat both(const cv::Mat& tone, const cv::Mat& accent);
void paint_wall(Material material, Canvas& canvas);
void paint_floor(Material material, Canvas& canvas);
void paint_thing(Material material, Canvas& canvas);
void paint_print(Material material, Canvas& canvas);

// Returns noise of several octaves, CV_32F within about [-1, 1]. The coarsest cells are cell_px high and stretch *
// cell_px wide. Each octave has half the cell size of the one before, and `gain` times its strength.
cv::Mat octave_noise(cv::Size size, cv::RNG& rng, double cell_px, double gain = 0.6, double stretch = 1);
// Adds strength * noise to `tone`, clipped.
void add_noise(cv::Mat& tone, const cv::Mat& noise, double strength);
// Returns a made-up word of 2 to 9 letters.
std::string random_word(cv::RNG& rng);
// Draws a line of made-up words, `height_px` high, from x = left to x = right.
void draw_text_line(cv::Mat& image, int left, int right, int baseline_y, int height_px, int tone, cv::RNG& rng);

}  // namespace rumi::synth
