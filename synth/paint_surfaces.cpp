// SPDX-License-Identifier: BSD-3-Clause
// Paints walls, floors, ceilings and the surfaces of things.
#include <opencv2/imgproc.hpp>

#include "synth/painter.h"

namespace rumi::synth {
namespace {

void fill(Canvas& c, int tone, double coarse_m, double strength) {
  c.tone.setTo(tone);
  add_noise(c.tone, octave_noise(c.size(), c.rng, std::max(2.0, coarse_m * c.px_per_m), 0.72), strength);
}

// Lets the accent colour show where the noise is above `threshold`: stains, dirt, moss.
void stain(Canvas& c, double coarse_m, double threshold, double strength) {
  cv::Mat mask = octave_noise(c.size(), c.rng, std::max(2.0, coarse_m * c.px_per_m), 0.6) - threshold;
  cv::Mat add;
  cv::multiply(cv::max(mask, 0), strength, add, 1, CV_8U);
  cv::add(c.accent, add, c.accent);
}

void specks(Canvas& c, double per_m2, double max_radius_m, int tone_low, int tone_high) {
  const double area = static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m);
  for (int i = static_cast<int>(per_m2 * area); i > 0; --i) {
    const cv::Point at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    const int radius = static_cast<int>(c.rng.uniform(0.2, 1.0) * max_radius_m * c.px_per_m);
    cv::ellipse(c.tone, at, {radius, std::max(0, static_cast<int>(radius * c.rng.uniform(0.4, 1.0)))},
                c.rng.uniform(0, 180), 0, 360, c.rng.uniform(tone_low, tone_high), cv::FILLED);
  }
}

void cracks(Canvas& c, double per_m2, double length_m, int tone) {
  const double area = static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m);
  for (int i = static_cast<int>(per_m2 * area); i > 0; --i) {
    cv::Point2d at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    double heading = c.rng.uniform(0.0, 2 * CV_PI);
    const int steps = c.rng.uniform(6, 30);
    for (int k = 0; k < steps; ++k) {
      heading += c.rng.uniform(-0.9, 0.9);
      const double step = length_m * c.px_per_m / steps;
      const cv::Point2d next = at + cv::Point2d(std::cos(heading), std::sin(heading)) * step;
      cv::line(c.tone, at, next, tone, k < steps / 2 ? 2 : 1, cv::LINE_AA);
      at = next;
    }
  }
}

void brick(Canvas& c) {
  fill(c, 150, 0.02, 22);  // mortar
  c.accent.setTo(150);
  const double length = 0.22, height = 0.07, joint = 0.011;
  for (int row = 0; row * height * c.px_per_m < c.tone.rows; ++row) {
    double x = -c.rng.uniform(0.02, length);
    while (x * c.px_per_m < c.tone.cols) {
      const double w = length * (c.rng.uniform(0, 6) == 0 ? 0.5 : c.rng.uniform(0.9, 1.08));
      const double wobble = c.rng.uniform(-0.003, 0.003);
      const cv::Rect r(static_cast<int>(x * c.px_per_m), static_cast<int>((row * height + wobble) * c.px_per_m),
                       c.px(w - joint), c.px(height - joint));
      cv::rectangle(c.tone, r, c.rng.uniform(60, 200), cv::FILLED);
      cv::rectangle(c.accent, r, c.rng.uniform(0, 14) == 0 ? c.rng.uniform(60, 180) : 0, cv::FILLED);
      x += w;
    }
  }
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.06 * c.px_per_m, 0.8), 24);
  specks(c, 160, 0.007, 20, 240);
  stain(c, 0.8, 0.7, 150);
}

void plaster(Canvas& c) {
  fill(c, 190, 0.9, 38);
  stain(c, 0.5, 0.6, 160);
  specks(c, 260, 0.012, 40, 255);
  cracks(c, 2.2, 0.7, 50);
  for (int i = static_cast<int>(static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m) * 5); i > 0;
       --i) {  // scuffs and old paint
    const cv::Point at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    const cv::Point to = at + cv::Point(c.px(c.rng.uniform(0.02, 0.3)), c.rng.uniform(-c.px(0.05), c.px(0.05)));
    cv::line(c.tone, at, to, c.rng.uniform(90, 240), c.rng.uniform(1, 4), cv::LINE_AA);
  }
}

void wallpaper(Canvas& c) {
  fill(c, 200, 0.7, 22);
  const double area = static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m);
  for (int i = static_cast<int>(area * 46); i > 0; --i) {  // sprigs of leaves and blossoms, no two alike
    cv::Point2d at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    double heading = c.rng.uniform(0.0, 2 * CV_PI);
    const double bend = c.rng.uniform(-0.35, 0.35);
    const int ink = c.rng.uniform(20, 120);
    for (int k = c.rng.uniform(4, 11); k > 0; --k) {
      heading += bend;
      const cv::Point2d next = at + cv::Point2d(std::cos(heading), std::sin(heading)) * (0.018 * c.px_per_m);
      cv::line(c.tone, at, next, ink, c.px(0.003), cv::LINE_AA);
      const double side = heading + (k % 2 ? 1.0 : -1.0);
      const cv::Point2d leaf = next + cv::Point2d(std::cos(side), std::sin(side)) * (0.014 * c.px_per_m);
      cv::ellipse(c.tone, leaf, {c.px(0.014), c.px(0.005)}, side * 180 / CV_PI, 0, 360, ink, cv::FILLED, cv::LINE_AA);
      at = next;
    }
    cv::circle(c.accent, at, c.px(c.rng.uniform(0.006, 0.018)), c.rng.uniform(140, 256), cv::FILLED, cv::LINE_AA);
  }
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.01 * c.px_per_m, 0.8), 10);
  stain(c, 0.9, 0.9, 110);
}

void stone(Canvas& c) {
  fill(c, 90, 0.03, 30);
  for (double y = 0; y < c.tone.rows;) {
    const double height = c.px(c.rng.uniform(0.10, 0.26));
    for (double x = -c.px(0.2); x < c.tone.cols;) {
      const double width = c.px(c.rng.uniform(0.14, 0.5)), cut = 0.016 * c.px_per_m;
      std::vector<cv::Point> corners;
      for (const auto& [u, v] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.5, 1.0}, {0.0, 1.0}})
        corners.emplace_back(static_cast<int>(x + cut + u * (width - 2 * cut) + c.rng.uniform(-cut, cut)),
                             static_cast<int>(y + cut + v * (height - 2 * cut) + c.rng.uniform(-cut, cut)));
      cv::fillConvexPoly(c.tone, corners, c.rng.uniform(90, 225), cv::LINE_AA);
      x += width;
    }
    y += height;
  }
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.2 * c.px_per_m, 0.8), 26);
  cracks(c, 6, 0.2, 40);
  stain(c, 0.6, 0.5, 180);
}

// Paints one board, with its grain along x.
void board(Canvas& c, const cv::Rect& where, int tone) {
  const cv::Rect r = where & cv::Rect({}, c.size());
  if (r.empty()) return;
  cv::Mat view = c.tone(r);
  view.setTo(tone);
  add_noise(view, octave_noise(r.size(), c.rng, std::max(2.0, 0.03 * c.px_per_m), 0.85, 14), 38);
  for (int knots = c.rng.uniform(-2, 4); knots > 0; --knots) {
    const cv::Point at(c.rng.uniform(0, r.width), c.rng.uniform(0, r.height));
    for (int k = 4; k > 0; --k)
      cv::ellipse(view, at, {c.px(0.007 * k), c.px(0.003 * k)}, c.rng.uniform(-12, 12), 0, 360, tone - 20 * (5 - k),
                  k == 1 ? cv::FILLED : 1, cv::LINE_AA);
  }
  for (int nails = c.rng.uniform(0, 3); nails > 0; --nails)
    cv::circle(view, {c.px(0.02), c.rng.uniform(0, r.height)}, c.px(0.003), 20, cv::FILLED, cv::LINE_AA);
  cv::rectangle(c.tone, where, 15, std::max(1, c.px(0.003)));
}

void boards(Canvas& c, double width_m) {
  for (int y = 0; y < c.tone.rows; y += c.px(width_m)) {
    int x = -c.rng.uniform(0, c.px(1.0));
    while (x < c.tone.cols) {
      const int length = c.px(c.rng.uniform(0.5, 1.7));
      board(c, {x, y, length, c.px(width_m)}, c.rng.uniform(95, 205));
      x += length;
    }
  }
  specks(c, 60, 0.008, 20, 230);
  cracks(c, 3, 0.3, 35);
  stain(c, 0.7, 0.8, 130);
}

void tile_motif(Canvas& c, const cv::Rect& r) {
  const cv::Point centre = (r.tl() + r.br()) / 2;
  const int kind = c.rng.uniform(0, 4), ink = c.rng.uniform(20, 110), n = c.rng.uniform(3, 9), half = r.width / 2;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * CV_PI * k / n + c.rng.uniform(-0.15, 0.15), reach = half * c.rng.uniform(0.4, 0.85);
    const cv::Point tip =
        centre + cv::Point(static_cast<int>(std::cos(angle) * reach), static_cast<int>(std::sin(angle) * reach));
    if (kind == 0) cv::line(c.tone, centre, tip, ink, c.px(0.007), cv::LINE_AA);
    if (kind == 1) cv::circle(c.tone, tip, half / 7, ink, cv::FILLED, cv::LINE_AA);
    if (kind == 2)
      cv::ellipse(c.accent, (centre + tip) / 2, {static_cast<int>(reach / 2), half / 8}, angle * 180 / CV_PI, 0, 360,
                  220, cv::FILLED, cv::LINE_AA);
    if (kind == 3) cv::circle(c.accent, centre, static_cast<int>(reach), 200, c.px(0.004), cv::LINE_AA);
  }
}

void tiles(Canvas& c) {
  fill(c, 60, 0.02, 20);
  const int pitch = c.px(c.rng.uniform(0.16, 0.3)), joint = c.px(0.006);
  for (int y = 0; y < c.tone.rows; y += pitch)
    for (int x = 0; x < c.tone.cols; x += pitch) {
      const cv::Rect r(x, y, pitch - joint, pitch - joint);
      cv::rectangle(c.tone, r, c.rng.uniform(130, 230), cv::FILLED);
      if (c.rng.uniform(0, 3) > 0) tile_motif(c, r);
    }
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.25 * c.px_per_m, 0.8), 22);
  specks(c, 90, 0.008, 20, 240);
  cracks(c, 1.2, 0.4, 40);
  stain(c, 0.8, 0.9, 120);
}

void carpet(Canvas& c) {
  fill(c, 150, 0.3, 34);
  const double area = static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m);
  for (int i = static_cast<int>(area * 60); i > 0; --i) {
    const cv::Point at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    cv::Mat& layer = c.rng.uniform(0, 2) ? c.tone : c.accent;
    const int n = c.rng.uniform(3, 7), radius = c.px(c.rng.uniform(0.015, 0.07));
    std::vector<cv::Point> polygon;
    polygon.reserve(n);
    for (int k = 0; k < n; ++k)
      polygon.push_back(at + cv::Point(static_cast<int>(radius * std::cos(2 * CV_PI * k / n)),
                                       static_cast<int>(radius * std::sin(2 * CV_PI * k / n))));
    if (c.rng.uniform(0, 2))
      cv::fillConvexPoly(layer, polygon, c.rng.uniform(0, 256), cv::LINE_AA);
    else
      cv::polylines(layer, polygon, true, c.rng.uniform(0, 256), c.px(0.006), cv::LINE_AA);
  }
  for (int k = 0; k < 3; ++k) {
    const int inset = c.px(0.05 + 0.06 * k);
    cv::rectangle(c.tone, {inset, inset, c.tone.cols - 2 * inset, c.tone.rows - 2 * inset}, k % 2 ? 230 : 30,
                  c.px(0.014));
  }
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.012 * c.px_per_m, 0.9), 26);
}

void ceiling(Canvas& c) {
  fill(c, 195, 1.2, 26);
  const int pitch = c.px(0.6);
  for (int y = 0; y < c.tone.rows; y += pitch)
    for (int x = 0; x < c.tone.cols; x += pitch) {
      cv::Mat panel = c.tone(cv::Rect(x, y, pitch, pitch) & cv::Rect({}, c.size()));
      panel.convertTo(panel, CV_8U, 1, c.rng.uniform(-22, 22));
    }
  specks(c, 520, 0.012, 20, 130);
  specks(c, 50, 0.05, 120, 235);
  for (int k = 0; k * pitch < std::max(c.tone.cols, c.tone.rows); ++k) {
    cv::line(c.tone, {k * pitch, 0}, {k * pitch, c.tone.rows}, 70, c.px(0.012));
    cv::line(c.tone, {0, k * pitch}, {c.tone.cols, k * pitch}, 70, c.px(0.012));
  }
  stain(c, 0.7, 0.7, 190);
}

void cloth(Canvas& c) {
  fill(c, 140, 0.12, 24);
  const int stripe = c.px(c.rng.uniform(0.02, 0.06));
  for (int x = 0; x < c.tone.cols; x += stripe + c.rng.uniform(1, stripe + 2))
    cv::rectangle(c.rng.uniform(0, 2) ? c.tone : c.accent, {x, 0, std::max(1, stripe / 2), c.tone.rows},
                  c.rng.uniform(0, 256), cv::FILLED);
  for (int y = 0; y < c.tone.rows; y += stripe + c.rng.uniform(1, stripe + 2))
    cv::rectangle(c.tone, {0, y, c.tone.cols, std::max(1, stripe / 3)}, c.rng.uniform(20, 240), cv::FILLED);
  specks(c, 900, 0.008, 10, 250);
  add_noise(c.tone, octave_noise(c.size(), c.rng, 0.01 * c.px_per_m, 0.9), 24);
}

void cardboard(Canvas& c) {
  fill(c, 170, 0.2, 18);
  const cv::Size s = c.size();
  const int line = std::max(5, s.height / 12);
  cv::rectangle(c.tone, {0, s.height / 2 - line / 2, s.width, line}, 235, cv::FILLED);  // tape
  const cv::Rect label(s.width / 10 + c.rng.uniform(0, s.width / 4 + 1),
                       s.height / 8 + c.rng.uniform(0, s.height / 6 + 1), s.width / 2, s.height / 3);
  cv::rectangle(c.tone, label, 250, cv::FILLED);
  for (int y = label.y + line; y < label.br().y - line / 2; y += line)
    draw_text_line(c.tone, label.x + 3, label.br().x - 3, y, std::max(4, line * 2 / 3), 20, c.rng);
  for (int x = label.x + label.width / 2; x < label.br().x - 3;) {  // bar code
    const int w = c.rng.uniform(1, std::max(2, c.px(0.005)) + 1);
    cv::rectangle(c.tone, {x, label.br().y - label.height / 4, w, label.height / 5}, 10, cv::FILLED);
    x += w + c.rng.uniform(1, std::max(2, c.px(0.006)) + 1);
  }
  draw_text_line(c.accent, s.width / 16, s.width, s.height * 7 / 8, std::max(6, s.height / 7), 220, c.rng);
  specks(c, 120, 0.006, 60, 240);
  cv::rectangle(c.tone, {0, 0, s.width, s.height}, 60, 2);
}

// Paints the back of a book, on which the text runs downwards.
void book(Canvas& c) {
  fill(c, c.rng.uniform(40, 220), 0.05, 14);
  const int ink = cv::mean(c.tone)[0] > 128 ? 10 : 245;
  const cv::Size s = c.size();
  for (int k = c.rng.uniform(1, 4); k > 0; --k) {
    const int y = c.rng.uniform(0, s.height);
    cv::rectangle(c.rng.uniform(0, 2) ? c.tone : c.accent, {0, y, s.width, c.px(c.rng.uniform(0.003, 0.02))},
                  c.rng.uniform(0, 2) ? ink : 230, cv::FILLED);
  }
  cv::Mat sideways = cv::Mat(s.width, s.height, CV_8U, cv::Scalar(0)), upright;
  const int text = std::max(4, std::min(s.width * 6 / 10, c.px(0.022)));
  draw_text_line(sideways, s.height / 12, s.height * 8 / 10, (s.width + text) / 2, text, 255, c.rng);
  cv::rotate(sideways, upright, cv::ROTATE_90_CLOCKWISE);
  c.tone.setTo(ink, upright > 90);
  cv::rectangle(c.tone, {0, 0, s.width, s.height}, 8, 1);
}

void leaf(Canvas& c) {
  fill(c, 130, 0.03, 50);
  const cv::Size s = c.size();
  cv::line(c.tone, {0, s.height / 2}, {s.width, s.height / 2}, 240, 2);
  for (int x = 2; x < s.width; x += c.px(0.012)) {
    cv::line(c.tone, {x, s.height / 2}, {x + s.height / 3, 0}, c.rng.uniform(160, 240), 1, cv::LINE_AA);
    cv::line(c.tone, {x, s.height / 2}, {x + s.height / 3, s.height}, c.rng.uniform(160, 240), 1, cv::LINE_AA);
  }
  specks(c, 800, 0.004, 20, 250);
}

void pot(Canvas& c) {
  fill(c, 150, 0.05, 30);
  for (int k = 0; k < 3; ++k) {
    const int y = c.rng.uniform(0, c.tone.rows), step = c.px(0.02);
    for (int x = 0; x < c.tone.cols; x += step)
      cv::circle(c.accent, {x, y + c.rng.uniform(-step, step)}, c.rng.uniform(1, step), 230,
                 c.rng.uniform(0, 2) ? cv::FILLED : 1);
  }
  specks(c, 700, 0.005, 20, 250);
}

}  // namespace

void paint_wall(Material material, Canvas& c) {
  if (material == Material::kBrick) return brick(c);
  if (material == Material::kWallpaper) return wallpaper(c);
  if (material == Material::kPanelling) return boards(c, 0.14);
  if (material == Material::kStone) return stone(c);
  plaster(c);
}

void paint_floor(Material material, Canvas& c) {
  if (material == Material::kPlanks) return boards(c, 0.11);
  if (material == Material::kTiles) return tiles(c);
  if (material == Material::kCarpet) return carpet(c);
  ceiling(c);
}

void paint_thing(Material material, Canvas& c) {
  if (material == Material::kCloth) return cloth(c);
  if (material == Material::kCardboard) return cardboard(c);
  if (material == Material::kBook) return book(c);
  if (material == Material::kLeaf) return leaf(c);
  if (material == Material::kPot) return pot(c);
  boards(c, 0.4);
}

}  // namespace rumi::synth
