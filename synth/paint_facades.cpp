// SPDX-License-Identifier: BSD-3-Clause
// Paints the fronts and roofs of houses.
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "synth/street_pictures.h"

namespace rumi::synth {
namespace {

// How the windows of one house look. Lengths in metres.
struct WindowStyle {
  double width, height, sill;
  int panes_across, panes_down;
  bool shutters, arch, frame_dark, flowers;
};

WindowStyle window_style(cv::RNG& rng) {
  return {rng.uniform(0.75, 1.5), rng.uniform(1.15, 1.75), rng.uniform(0.7, 0.95),
          rng.uniform(1, 4),      rng.uniform(1, 4),       rng.uniform(0, 3) == 0,
          rng.uniform(0, 4) == 0, rng.uniform(0, 3) == 0,  rng.uniform(0, 4) == 0};
}

class FacadePainter {
 public:
  FacadePainter(const Facade& facade, Canvas& canvas) : f_(facade), c_(canvas), style_(window_style(canvas.rng)) {}

  void paint() {
    wall();
    const double pitch = style_.width + c_.rng.uniform(0.6, 1.6);
    const int columns = std::max(1, static_cast<int>((f_.width_m - 0.4) / pitch));
    const double storey = f_.height_m / f_.storeys;
    const int door = f_.door ? c_.rng.uniform(0, columns) : -1;
    for (int k = 0; k < f_.storeys; ++k) {
      const double floor = f_.height_m - k * storey;  // from the top, m
      if (k > 0 && band_) bar(0, floor - 0.08, f_.width_m, 0.16, 235, 0);
      if (k == 0 && f_.shop) {
        shop(floor);
        continue;
      }
      for (int i = 0; i < columns; ++i) {
        const double middle = (i + 0.5) * f_.width_m / columns;
        if (k == 0 && i == door)
          entrance(middle, floor);
        else if (c_.rng.uniform(0, 14) > 0)
          window(middle, floor - style_.sill - style_.height, storey);
      }
    }
    trimmings();
  }

 private:
  void wall() {
    static constexpr Material kWalls[] = {Material::kBrick, Material::kPlaster, Material::kPlaster, Material::kStone};
    const Material material = kWalls[c_.rng.uniform(0, 4)];
    paint_wall(material, c_);
    c_.accent.convertTo(c_.accent, CV_8U, 0.1);
    const double contrast = material == Material::kPlaster ? 0.42 : 0.62;
    c_.tone.convertTo(c_.tone, CV_8U, contrast, 200 - 185 * contrast);
    // Rain and splashes darken the top and the foot.
    for (int y = 0; y < c_.tone.rows; ++y) {
      const double up = (c_.tone.rows - y) / c_.px_per_m, down = y / c_.px_per_m;
      const double shade = 1 - 0.28 * std::exp(-up / 0.5) - 0.15 * std::exp(-down / 0.4);
      c_.tone.row(y).convertTo(c_.tone.row(y), CV_8U, shade);
    }
    band_ = c_.rng.uniform(0, 2);
  }

  cv::Rect rect(double x, double y, double w, double h) const {
    return {static_cast<int>(std::lround(x * c_.px_per_m)), static_cast<int>(std::lround(y * c_.px_per_m)), c_.px(w),
            c_.px(h)};
  }

  void bar(double x, double y, double w, double h, int tone, int accent) {
    cv::rectangle(c_.tone, rect(x, y, w, h), tone, cv::FILLED);
    cv::rectangle(c_.accent, rect(x, y, w, h), accent, cv::FILLED);
  }

  // Glass shows the dark room, a curtain, or the sky and the houses across the street.
  void glass(double x, double y, double w, double h) {
    const cv::Rect r = rect(x, y, w, h) & cv::Rect({}, c_.size());
    if (r.area() < 4) return;
    const int dark = c_.rng.uniform(8, 75), bright = c_.rng.uniform(60, 190);
    const int horizon = c_.rng.uniform(r.height / 5, r.height);
    for (int row = 0; row < r.height; ++row)
      c_.tone(cv::Rect(r.x, r.y + row, r.width, 1)).setTo(row < horizon ? (dark + bright) / 2 : dark);
    c_.accent(r).setTo(0);
    if (c_.rng.uniform(0, 3) == 0) {
      const int curtain = c_.rng.uniform(r.width / 6, r.width / 2 + 1), ink = c_.rng.uniform(120, 245);
      c_.tone(cv::Rect(r.x, r.y, std::max(1, curtain), r.height)).setTo(ink);
      if (c_.rng.uniform(0, 2))
        c_.tone(cv::Rect(r.br().x - std::max(1, curtain), r.y, std::max(1, curtain), r.height)).setTo(ink);
    } else if (c_.rng.uniform(0, 4) == 0) {
      c_.tone(cv::Rect(r.x, r.y, r.width, c_.rng.uniform(1, r.height + 1))).setTo(c_.rng.uniform(120, 230));  // blind
    }
    for (int i = 0; i < 2; ++i)
      cv::line(c_.tone(r), {c_.rng.uniform(0, r.width), 0}, {c_.rng.uniform(0, r.width), r.height},
               c_.rng.uniform(30, 110), 1);
  }

  void window(double middle, double top, double storey) {
    const double w = style_.width, h = std::min(style_.height, storey - style_.sill - 0.25);
    const double x = middle - w / 2, y = std::max(0.05, top);
    const int frame = style_.frame_dark ? 25 : 250;
    if (style_.shutters)
      for (const double side : {x - 0.5 * w, x + w}) {
        bar(side, y, 0.5 * w, h, 90, 255);
        for (double slat = y + 0.1; slat < y + h - 0.05; slat += 0.12)
          bar(side + 0.05, slat, 0.5 * w - 0.1, 0.04, 30, 160);
      }
    bar(x - 0.07, y - 0.07, w + 0.14, h + 0.14, frame, 0);
    glass(x, y, w, h);
    for (int i = 1; i < style_.panes_across; ++i) bar(x + w * i / style_.panes_across - 0.025, y, 0.05, h, frame, 0);
    for (int i = 1; i < style_.panes_down; ++i) bar(x, y + h * i / style_.panes_down - 0.025, w, 0.05, frame, 0);
    bar(x - 0.15, y + h + 0.06, w + 0.3, 0.09, 215, 0);
    bar(x - 0.13, y + h + 0.15, w + 0.26, 0.05, 40, 0);  // the shadow of the sill
    if (style_.arch)
      cv::ellipse(c_.tone, rect(middle, y - 0.06, 0, 0).tl(), {c_.px(w / 2), c_.px(0.18)}, 0, 180, 360, 225,
                  c_.px(0.1));
    if (style_.flowers && c_.rng.uniform(0, 2))
      for (int i = 0; i < 26; ++i)
        cv::circle(i % 2 ? c_.tone : c_.accent,
                   rect(x + c_.rng.uniform(0.0, w), y + h - c_.rng.uniform(0.0, 0.25), 0, 0).tl(), c_.px(0.05),
                   i % 2 ? 40 : 250, cv::FILLED);
  }

  void entrance(double middle, double floor) {
    const double w = c_.rng.uniform(0.9, 1.3), h = c_.rng.uniform(2.05, 2.35), x = middle - w / 2, y = floor - h;
    bar(x - 0.12, y - 0.12, w + 0.24, h + 0.12, 230, 0);
    bar(x, y, w, h, c_.rng.uniform(40, 150), 235);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        if (j == 0 && i + j < 2)
          glass(x + 0.12 + i * w / 2, y + 0.18, w / 2 - 0.22, 0.6);
        else
          bar(x + 0.12 + i * w / 2, y + 1.0, w / 2 - 0.22, h - 1.25, 25, 140);
    bar(x + w - 0.14, y + 1.0, 0.06, 0.16, 250, 0);
    bar(x - 0.3, floor - 0.1, w + 0.6, 0.1, 150, 0);  // step
    draw_text_line(c_.tone, static_cast<int>((x + w + 0.2) * c_.px_per_m),
                   static_cast<int>((x + w + 0.5) * c_.px_per_m), static_cast<int>((y + 0.5) * c_.px_per_m),
                   c_.px(0.14), 15, c_.rng);
  }

  void shop(double floor) {
    const double h = 2.15, y = floor - h - 0.2, w = f_.width_m;
    bar(0, y - 0.75, w, 0.12, 20, 0);
    bar(0.1, y - 0.65, w - 0.2, 0.55, c_.rng.uniform(30, 220), c_.rng.uniform(0, 2) ? 255 : 60);
    const int ink = c_.rng.uniform(0, 2) ? 252 : 8;
    const cv::Rect sign = rect(0.4, y - 0.22, w - 0.8, 0.1);
    draw_text_line(c_.tone, sign.x, sign.br().x, sign.y, c_.px(0.38), ink, c_.rng);
    const int panes = std::max(2, static_cast<int>(w / c_.rng.uniform(1.4, 2.4))), door = c_.rng.uniform(0, panes);
    for (int i = 0; i < panes; ++i) {
      const double x = 0.15 + i * (w - 0.3) / panes, pw = (w - 0.3) / panes - 0.12;
      glass(x, y, pw, i == door ? h + 0.15 : h - 0.35);
      for (int k = 0; k < 14; ++k)  // goods and notices
        bar(x + c_.rng.uniform(0.02, std::max(0.03, pw - 0.3)), y + c_.rng.uniform(0.1, h - 0.75),
            c_.rng.uniform(0.06, 0.3), c_.rng.uniform(0.06, 0.4), c_.rng.uniform(10, 255),
            c_.rng.uniform(0, 3) ? 0 : 220);
    }
  }

  void trimmings() {
    bar(0, 0, f_.width_m, 0.16, 225, 0);  // cornice
    bar(0, 0.16, f_.width_m, 0.07, 35, 0);
    if (c_.rng.uniform(0, 2))
      bar(c_.rng.uniform(0, 2) ? 0.12 : f_.width_m - 0.24, 0.1, 0.11, f_.height_m, 60, 0);  // drainpipe
    for (int i = c_.rng.uniform(0, 4); i > 0; --i)                                          // lamps, boxes, plates
      bar(c_.rng.uniform(0.3, f_.width_m - 0.5), f_.height_m - c_.rng.uniform(1.2, 2.6), c_.rng.uniform(0.1, 0.35),
          c_.rng.uniform(0.12, 0.4), c_.rng.uniform(10, 250), c_.rng.uniform(0, 2) * 200);
  }

  const Facade& f_;
  Canvas& c_;
  WindowStyle style_;
  bool band_ = false;
};

cv::Vec3b shifted(cv::Vec3b colour, int amount, cv::RNG& rng) {
  for (int k = 0; k < 3; ++k) colour[k] = cv::saturate_cast<uchar>(colour[k] + rng.uniform(-amount, amount + 1));
  return colour;
}

}  // namespace

cv::Mat paint_facade(const Facade& facade, double px_per_m, cv::RNG& rng) {
  const auto px = [&](double metres) {
    return std::clamp(static_cast<int>(std::lround(metres * px_per_m)), 16, TextureAtlas::kMaxPatch);
  };
  const cv::Size size(px(facade.width_m), px(facade.height_m));
  Canvas canvas{cv::Mat(size, CV_8U, cv::Scalar(128)), cv::Mat::zeros(size, CV_8U), px_per_m, rng};
  FacadePainter(facade, canvas).paint();
  return both(canvas.tone, canvas.accent);
}

Palette facade_palette(cv::RNG& rng) {
  static const cv::Vec3b kWalls[] = {{224, 200, 168}, {232, 226, 212}, {214, 150, 112}, {205, 128, 92},
                                     {236, 214, 150}, {196, 200, 196}, {226, 184, 170}, {178, 192, 206},
                                     {198, 208, 172}, {240, 238, 232}};
  static const cv::Vec3b kDoors[] = {{36, 70, 60},   {120, 30, 28}, {30, 52, 104}, {92, 58, 30},
                                     {150, 110, 40}, {24, 92, 50},  {70, 70, 74},  {170, 60, 30}};
  return {shifted({34, 34, 36}, 8, rng), shifted(kWalls[rng.uniform(0, 10)], 16, rng),
          shifted(kDoors[rng.uniform(0, 8)], 18, rng)};
}

cv::Mat paint_roof(cv::Size size, double px_per_m, cv::RNG& rng) {
  Canvas c{cv::Mat(size, CV_8U, cv::Scalar(110)), cv::Mat::zeros(size, CV_8U), px_per_m, rng};
  const int row = std::max(3, c.px(0.3)), tile = std::max(3, c.px(rng.uniform(0.22, 0.4)));
  for (int y = 0, k = 0; y < size.height; y += row, ++k)
    for (int x = -(k % 2) * tile / 2; x < size.width; x += tile) {
      cv::rectangle(c.tone, cv::Rect(x, y, tile, row), rng.uniform(90, 215), cv::FILLED);
      cv::rectangle(c.tone, cv::Rect(x, y + row - std::max(1, row / 5), tile, std::max(1, row / 5)), 40, cv::FILLED);
    }
  add_noise(c.tone, octave_noise(size, rng, 1.2 * px_per_m, 0.7), 24);
  for (int i = rng.uniform(0, 3); i > 0; --i) {  // skylights
    const cv::Rect r(rng.uniform(0, size.width), rng.uniform(size.height / 5, size.height / 2), c.px(0.8), c.px(1.1));
    cv::rectangle(c.tone, r, 230, cv::FILLED);
    cv::rectangle(c.tone, cv::Rect(r.x + 2, r.y + 2, r.width - 4, r.height - 4), 25, cv::FILLED);
  }
  return both(c.tone, c.accent);
}

Palette roof_palette(cv::RNG& rng) {
  static const cv::Vec3b kTiles[] = {{178, 84, 58}, {150, 74, 56}, {112, 98, 92}, {96, 100, 112}, {132, 92, 70}};
  return {{34, 26, 26}, shifted(kTiles[rng.uniform(0, 5)], 16, rng), {80, 90, 60}};
}

}  // namespace rumi::synth
