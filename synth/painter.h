// SPDX-License-Identifier: BSD-3-Clause
// Paints the surfaces of the room: every object gets a picture of its own, because a repeated one would mislead SLAM.
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

// A painted picture has two channels: tone leads from `dark` to `light`, the accent channel from there to `accent`.
struct Palette {
  cv::Vec3b dark, light, accent;  // R, G, B
};

// CV_8UC2, size in pixels, px_per_m pixels to the metre.
cv::Mat paint(Material material, cv::Size size, double px_per_m, cv::RNG& rng);
Palette random_palette(Material material, cv::RNG& rng);

// The two halves of paint(): each draws on a canvas of its own material, prepared with noise.
struct Canvas {
  cv::Mat tone, accent;  // CV_8UC1
  double px_per_m;
  cv::RNG& rng;

  int px(double metres) const { return std::max(1, static_cast<int>(std::floor(metres * px_per_m + 0.5))); }
  cv::Size size() const { return tone.size(); }
};
void paint_wall(Material material, Canvas& canvas);
void paint_floor(Material material, Canvas& canvas);
void paint_thing(Material material, Canvas& canvas);
void paint_print(Material material, Canvas& canvas);

// Noise of several octaves, CV_32F within about [-1, 1]. The coarsest cells are cell_px high and stretch * cell_px
// wide, each octave has half the cell and `gain` times the strength of the one before.
cv::Mat octave_noise(cv::Size size, cv::RNG& rng, double cell_px, double gain = 0.6, double stretch = 1);
// tone += strength * noise, clipped.
void add_noise(cv::Mat& tone, const cv::Mat& noise, double strength);
// A made-up word of 2 to 9 letters.
std::string random_word(cv::RNG& rng);
// A line of made-up words, `height_px` high, from x = left up to right.
void draw_text_line(cv::Mat& image, int left, int right, int baseline_y, int height_px, int tone, cv::RNG& rng);

}  // namespace rumi::synth
