// SPDX-License-Identifier: BSD-3-Clause
#include "synth/painter.h"

#include <map>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace rumi::synth {
namespace {

// Materials that have a few palettes of their own. Any other material may have any colour.
const std::map<Material, std::vector<Palette>> kPalettes = {
    {Material::kBrick,
     {{{70, 38, 30}, {190, 110, 80}, {205, 195, 180}}, {{80, 62, 45}, {205, 165, 120}, {215, 210, 200}}}},
    {Material::kPlaster,
     {{{120, 112, 96}, {238, 230, 212}, {95, 70, 50}},
      {{95, 110, 118}, {212, 226, 230}, {80, 76, 70}},
      {{110, 120, 88}, {222, 228, 196}, {100, 80, 50}}}},
    {Material::kWallpaper,
     {{{50, 82, 78}, {210, 214, 190}, {170, 70, 50}},
      {{92, 40, 48}, {226, 200, 176}, {60, 90, 60}},
      {{44, 58, 96}, {212, 210, 216}, {190, 150, 60}}}},
    {Material::kPanelling,
     {{{62, 36, 18}, {190, 132, 78}, {40, 22, 12}}, {{88, 62, 36}, {222, 182, 128}, {60, 40, 22}}}},
    {Material::kPlanks, {{{62, 36, 18}, {190, 132, 78}, {40, 22, 12}}, {{88, 62, 36}, {222, 182, 128}, {60, 40, 22}}}},
    {Material::kWood,
     {{{58, 32, 16}, {172, 112, 62}, {36, 20, 10}},
      {{110, 80, 48}, {228, 192, 140}, {72, 48, 26}},
      {{40, 30, 26}, {112, 84, 68}, {24, 16, 14}},
      {{140, 140, 136}, {228, 228, 222}, {90, 90, 90}}}},
    {Material::kStone, {{{60, 60, 62}, {188, 184, 174}, {96, 90, 70}}, {{84, 72, 56}, {206, 190, 158}, {70, 80, 60}}}},
    {Material::kTiles, {{{70, 66, 60}, {214, 208, 196}, {60, 84, 120}}, {{80, 50, 36}, {206, 150, 110}, {40, 60, 60}}}},
    {Material::kCeiling, {{{110, 110, 106}, {232, 230, 224}, {80, 74, 66}}}},
    {Material::kCardboard,
     {{{84, 56, 32}, {206, 164, 112}, {40, 36, 36}}, {{96, 70, 46}, {218, 184, 136}, {150, 40, 30}}}},
    {Material::kLeaf, {{{16, 46, 14}, {104, 164, 62}, {190, 200, 90}}, {{24, 60, 30}, {130, 178, 96}, {170, 120, 60}}}},
    {Material::kPot,
     {{{80, 40, 26}, {196, 112, 74}, {230, 220, 200}}, {{40, 52, 70}, {150, 170, 190}, {235, 235, 235}}}},
    {Material::kWindow, {{{52, 70, 60}, {226, 236, 250}, {96, 84, 72}}}},
};

// Returns a random colour of usual inks and dyes: mostly muted, few greens and purples.
cv::Vec3b hue(cv::RNG& rng, int brightness, double saturation) {
  static const cv::Vec3f kInks[] = {{1.f, .30f, .22f},  {1.f, .62f, .20f}, {1.f, .85f, .45f},  {.55f, .72f, .42f},
                                    {.30f, .62f, .60f}, {.35f, .60f, 1.f}, {.32f, .42f, .80f}, {.72f, .50f, .66f},
                                    {.80f, .62f, .46f}, {.85f, .85f, .85f}};
  const cv::Vec3f ink = kInks[rng.uniform(0, static_cast<int>(std::size(kInks)))];
  cv::Vec3b out;
  for (int c = 0; c < 3; ++c)
    out[c] =
        cv::saturate_cast<uchar>(brightness * (1 - saturation + saturation * (ink[c] + rng.uniform(-0.08f, 0.08f))));
  return out;
}

cv::Vec3b jitter(cv::Vec3b colour, int amount, cv::RNG& rng) {
  const int shade = rng.uniform(-amount, amount + 1);
  for (int c = 0; c < 3; ++c)
    colour[c] = cv::saturate_cast<uchar>(colour[c] + shade + rng.uniform(-amount / 3, amount / 3 + 1));
  return colour;
}

Palette jittered(const Palette& p, int amount, cv::RNG& rng) {
  return {jitter(p.dark, amount, rng), jitter(p.light, amount, rng), jitter(p.accent, amount, rng)};
}

}  // namespace

cv::Mat octave_noise(cv::Size size, cv::RNG& rng, double cell_px, double gain, double stretch) {
  cv::Mat sum = cv::Mat::zeros(size, CV_32F);
  double strength = 1;
  for (double cell = cell_px; cell >= 1; cell /= 2, strength *= gain) {
    const cv::Size grid(static_cast<int>(size.width / (cell * stretch)) + 3, static_cast<int>(size.height / cell) + 3);
    cv::Mat coarse(grid, CV_32F), fine;
    rng.fill(coarse, cv::RNG::UNIFORM, -strength, strength);
    const cv::Size full(std::max(size.width, static_cast<int>(grid.width * cell * stretch)),
                        std::max(size.height, static_cast<int>(grid.height * cell)));
    cv::resize(coarse, fine, full, 0, 0, cell > 8 ? cv::INTER_CUBIC : cv::INTER_LINEAR);
    sum += fine(cv::Rect(0, 0, size.width, size.height));
  }
  return sum;
}

void add_noise(cv::Mat& tone, const cv::Mat& noise, double strength) {
  cv::add(tone, noise * strength, tone, {}, CV_8U);
}

std::string random_word(cv::RNG& rng) {
  static const std::string kLetters = "eeeaaioutnsrlhdcmpfgbvykwxzqj";
  const bool capital = rng.uniform(0, 4) == 0;
  std::string word;
  const int length = rng.uniform(2, 10);
  for (int i = 0; i < length; ++i) {
    const char letter = kLetters[rng.uniform(0, static_cast<int>(kLetters.size()))];
    word += (i == 0 && capital) ? static_cast<char>(letter - 32) : letter;
  }
  return word;
}

void draw_text_line(cv::Mat& image, int left, int right, int baseline_y, int height_px, int tone, cv::RNG& rng) {
  static const int kFonts[] = {cv::FONT_HERSHEY_SIMPLEX, cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_TRIPLEX,
                               cv::FONT_HERSHEY_COMPLEX};
  const int font = kFonts[rng.uniform(0, 4)];
  const double scale = height_px / 22.0;
  const int thickness = std::max(1, height_px / 9);
  std::string line = random_word(rng);
  for (int guard = 0; guard < 40; ++guard) {
    const std::string longer = line + " " + random_word(rng);
    if (cv::getTextSize(longer, font, scale, thickness, nullptr).width > right - left) break;
    line = longer;
  }
  cv::putText(image, line, {left, baseline_y}, font, scale, cv::Scalar(tone), thickness, cv::LINE_AA);
}

cv::Mat both(const cv::Mat& tone, const cv::Mat& accent) {
  cv::Mat out;
  cv::merge(std::vector<cv::Mat>{tone, accent}, out);
  return out;
}

cv::Mat paint(Material material, cv::Size size, double px_per_m, cv::RNG& rng) {
  Canvas canvas{cv::Mat(size, CV_8U, cv::Scalar(128)), cv::Mat::zeros(size, CV_8U), px_per_m, rng};
  if (material <= Material::kStone) {
    paint_wall(material, canvas);
  } else if (material <= Material::kCeiling) {
    paint_floor(material, canvas);
  } else if (material == Material::kPoster || material == Material::kPicture || material == Material::kScreen ||
             material == Material::kWindow || material == Material::kPaper) {
    paint_print(material, canvas);
  } else {
    paint_thing(material, canvas);
  }
  return both(canvas.tone, canvas.accent);
}

Palette random_palette(Material material, cv::RNG& rng) {
  if (const auto found = kPalettes.find(material); found != kPalettes.end()) {
    const std::vector<Palette>& palettes = found->second;
    return jittered(palettes[rng.uniform(0, static_cast<int>(palettes.size()))], 14, rng);
  }
  switch (material) {
    case Material::kCarpet:
      return {hue(rng, 90, 0.7), hue(rng, 225, 0.35), hue(rng, 170, 0.8)};
    case Material::kScreen:
      return {{14, 18, 26}, hue(rng, 235, 0.35), hue(rng, 225, 0.8)};
    case Material::kPaper:
      return {{24, 24, 30}, {240, 238, 230}, hue(rng, 190, 0.8)};
    case Material::kCloth:
    case Material::kBook:
      return rng.uniform(0, 3) ? Palette{hue(rng, rng.uniform(50, 110), 0.8), hue(rng, rng.uniform(170, 240), 0.5),
                                         hue(rng, 225, 0.7)}
                               : Palette{{30, 30, 34}, {224, 220, 208}, hue(rng, 200, 0.8)};
    default:  // posters and pictures
      return {hue(rng, rng.uniform(20, 80), 0.6), hue(rng, rng.uniform(205, 250), 0.25), hue(rng, 220, 0.85)};
  }
}

}  // namespace rumi::synth
