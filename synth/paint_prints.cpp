// SPDX-License-Identifier: BSD-3-Clause
// Printed matter: posters, pictures, papers, screens, and the view from a window.
#include <opencv2/imgproc.hpp>

#include "synth/painter.h"

namespace rumi::synth {
namespace {

cv::Rect inside(const Canvas& c, double fraction) {
  const int border = static_cast<int>(fraction * std::min(c.tone.cols, c.tone.rows));
  return {border, border, c.tone.cols - 2 * border, c.tone.rows - 2 * border};
}

void text_block(Canvas& c, const cv::Rect& r, int height_px, int ink) {
  for (int y = r.y + height_px; y < r.br().y; y += height_px * 3 / 2 + 1) {
    const bool last_of_paragraph = c.rng.uniform(0, 6) == 0;
    draw_text_line(c.tone, r.x, last_of_paragraph ? r.x + r.width / 2 : r.br().x, y, height_px, ink, c.rng);
  }
}

// Returns a "photograph": noise as a landscape with light and shade.
cv::Mat landscape(cv::Size size, cv::RNG& rng) {
  cv::Mat picture(size, CV_8U);
  for (int y = 0; y < size.height; ++y) {
    const int level = 230 - 60 * y / size.height;
    picture.row(y).setTo(level);
  }
  add_noise(picture, octave_noise(size, rng, size.height * 0.4, 0.55, 2), 26);  // clouds
  for (int layer = 0; layer < 4; ++layer) {
    const cv::Mat ridge = octave_noise({size.width, 1}, rng, size.width * 0.3, 0.55);
    cv::Mat ground(size, CV_8U, cv::Scalar(175 - 38 * layer));
    add_noise(ground, octave_noise(size, rng, size.height * 0.1, 0.85), 34);
    for (int x = 0; x < size.width; ++x) {
      const int top = std::clamp(static_cast<int>(size.height * (0.3 + 0.16 * layer + 0.12 * ridge.at<float>(0, x))), 0,
                                 size.height - 1);
      ground.col(x).rowRange(top, size.height).copyTo(picture.col(x).rowRange(top, size.height));
    }
  }
  return picture;
}

void halftone(Canvas& c, const cv::Rect& r) {
  const cv::Mat photo = landscape(r.size(), c.rng);
  const int step = std::max(4, c.px(0.011));
  for (int y = step / 2, row = 0; y < r.height; y += step, ++row)
    for (int x = (row % 2) * step / 2; x < r.width; x += step) {
      const double darkness = 1 - photo.at<uchar>(y, x) / 255.0;
      cv::circle(c.tone, r.tl() + cv::Point(x, y), static_cast<int>(step * 0.72 * std::sqrt(darkness)), 20, cv::FILLED,
                 cv::LINE_AA);
    }
}

void map(Canvas& c, const cv::Rect& r) {
  const cv::Mat height = octave_noise(r.size(), c.rng, r.width * 0.35, 0.5);
  cv::Mat bands, edges;
  height.convertTo(bands, CV_8U, 40, 128);
  bands = bands / 9 * 9;
  cv::morphologyEx(bands, edges, cv::MORPH_GRADIENT, cv::Mat::ones(2, 2, CV_8U));
  c.tone(r).setTo(110, edges > 0);
  c.accent(r).setTo(150, height < -0.45);  // lakes
  for (int road = 0; road < 9; ++road) {
    cv::Point2d at(r.x + c.rng.uniform(0, r.width), r.y + c.rng.uniform(0, r.height));
    double heading = c.rng.uniform(0.0, 2 * CV_PI);
    for (int k = 0; k < 60; ++k) {
      heading += c.rng.uniform(-0.3, 0.3);
      const cv::Point2d next = at + cv::Point2d(std::cos(heading), std::sin(heading)) * (r.width / 60.0);
      if (!r.contains(next)) break;
      cv::line(road % 2 ? c.tone : c.accent, at, next, road % 2 ? 15 : 250, 1 + road % 3, cv::LINE_AA);
      if (c.rng.uniform(0, 7) == 0) cv::circle(c.tone, at, 3, 10, cv::FILLED, cv::LINE_AA);
      if (c.rng.uniform(0, 9) == 0)
        cv::putText(c.tone, random_word(c.rng), at, cv::FONT_HERSHEY_SIMPLEX, 0.35, 5, 1, cv::LINE_AA);
      at = next;
    }
  }
}

void shapes(Canvas& c, const cv::Rect& r) {
  for (int i = 0; i < 70; ++i) {
    cv::Mat layer = (c.rng.uniform(0, 3) ? c.tone : c.accent)(r);
    const cv::Point at(c.rng.uniform(0, r.width), c.rng.uniform(0, r.height));
    const int size = static_cast<int>(r.width * c.rng.uniform(0.02, 0.16)), ink = c.rng.uniform(0, 256);
    const int thickness = c.rng.uniform(0, 2) ? cv::FILLED : std::max(1, size / 6);
    if (i % 3 == 0) {
      cv::circle(layer, at, size, ink, thickness, cv::LINE_AA);
    } else if (i % 3 == 1) {
      const cv::RotatedRect box(at, cv::Size2f(static_cast<float>(size) * 2.f, static_cast<float>(size)),
                                c.rng.uniform(0.f, 180.f));
      cv::Point2f corners[4];
      box.points(corners);
      std::vector<cv::Point> polygon(corners, corners + 4);
      cv::fillConvexPoly(layer, polygon, ink, cv::LINE_AA);
    } else {
      const double angle = c.rng.uniform(0.0, 2 * CV_PI);
      cv::line(
          layer, at,
          at + cv::Point(static_cast<int>(3 * size * std::cos(angle)), static_cast<int>(3 * size * std::sin(angle))),
          ink, std::max(1, size / 8), cv::LINE_AA);
    }
  }
}

void chart(Canvas& c, const cv::Rect& r) {
  const int columns = c.rng.uniform(5, 9), rows = c.rng.uniform(6, 11);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const cv::Rect cell(r.x + r.width * column / columns, r.y + r.height * row / rows, r.width / columns - 3,
                          r.height / rows - 3);
      if (cell.width < 4 || cell.height < 4) continue;
      cv::rectangle(c.tone, cell, c.rng.uniform(120, 256), cv::FILLED);
      if (c.rng.uniform(0, 3) == 0) cv::rectangle(c.accent, cell, c.rng.uniform(80, 220), cv::FILLED);
      cv::putText(c.tone, random_word(c.rng).substr(0, 2), {cell.x + 2, cell.br().y - cell.height / 4},
                  cv::FONT_HERSHEY_DUPLEX, cell.height / 45.0, 10, 1, cv::LINE_AA);
      draw_text_line(c.tone, cell.x + 2, cell.br().x - 2, cell.br().y - 2, std::max(4, cell.height / 7), 30, c.rng);
    }
}

void page(Canvas& c, const cv::Rect& r) {
  const int line = std::max(5, c.px(0.008));
  draw_text_line(c.tone, r.x, r.br().x, r.y + r.height / 10, std::max(8, r.height / 14), 15, c.rng);
  const cv::Rect photo(r.x, r.y + r.height / 7, r.width, r.height / 3);
  if (c.rng.uniform(0, 3) > 0)
    halftone(c, photo);
  else
    landscape(photo.size(), c.rng).copyTo(c.tone(photo));
  const int top = photo.br().y + line, gap = r.width / 20, columns = r.width > c.px(0.4) ? 3 : 2;
  for (int k = 0; k < columns; ++k)
    text_block(c, {r.x + k * (r.width + gap) / columns, top, (r.width + gap) / columns - gap, r.br().y - top}, line,
               30);
}

void poster(Canvas& c) {
  c.tone.setTo(c.rng.uniform(200, 246));
  const cv::Rect r = inside(c, 0.05);
  if (r.width < 12 || r.height < 12) return;
  switch (c.rng.uniform(0, 6)) {
    case 0:
      map(c, r);
      break;
    case 1:
      halftone(c, r);
      break;
    case 2:
      shapes(c, r);
      break;
    case 3:
      chart(c, r);
      break;
    default:
      page(c, r);
      break;
  }
  if (c.rng.uniform(0, 2))
    draw_text_line(c.accent, r.x, r.br().x, r.br().y - r.height / 20, std::max(6, r.height / 9), 235, c.rng);
  add_noise(c.tone, octave_noise(c.size(), c.rng, c.px(0.2), 0.7), 9);
  cv::rectangle(c.tone, {0, 0, c.tone.cols, c.tone.rows}, c.rng.uniform(0, 2) ? 20 : 250, std::max(2, c.px(0.006)));
}

void picture(Canvas& c) {
  landscape(c.size(), c.rng).copyTo(c.tone);
  cv::Mat warm = octave_noise(c.size(), c.rng, c.tone.rows * 0.2, 0.7);
  warm.convertTo(c.accent, CV_8U, 110, 20);
  const double area = static_cast<double>(c.tone.total()) / (c.px_per_m * c.px_per_m);
  for (int i = static_cast<int>(area * 700); i > 0; --i) {  // brush strokes
    const cv::Point at(c.rng.uniform(0, c.tone.cols), c.rng.uniform(0, c.tone.rows));
    const int tone = std::clamp(c.tone.at<uchar>(at) + c.rng.uniform(-70, 70), 0, 255);
    cv::ellipse(c.tone, at, {c.px(0.018), c.px(0.004)}, c.rng.uniform(0, 180), 0, 360, tone, cv::FILLED, cv::LINE_AA);
  }
  const int frame = c.px(0.035);
  cv::rectangle(c.accent, {0, 0, c.tone.cols, c.tone.rows}, 0, 2 * frame);
  cv::rectangle(c.tone, {0, 0, c.tone.cols, c.tone.rows}, 40, 2 * frame);
  for (int i = 0; i < 4; ++i)
    cv::rectangle(c.tone,
                  cv::Rect(i * frame / 4, i * frame / 4, c.tone.cols - i * frame / 2, c.tone.rows - i * frame / 2),
                  60 + 40 * (i % 3), 2);
}

void screen(Canvas& c) {
  c.tone.setTo(20);
  const cv::Rect r = inside(c, 0.04);
  for (int i = 0; i < 4; ++i) {
    const cv::Rect window(r.x + c.rng.uniform(0, r.width / 2), r.y + c.rng.uniform(0, r.height / 2), r.width / 2 - 4,
                          r.height / 2 - 4);
    if (window.width < 8 || window.height < 12) continue;
    const bool dark = c.rng.uniform(0, 2);
    cv::rectangle(c.tone, window, dark ? 50 : 235, cv::FILLED);
    cv::rectangle(c.accent, {window.x, window.y, window.width, std::max(3, window.height / 10)}, 230, cv::FILLED);
    const int line = std::max(5, c.px(0.009));
    for (int y = window.y + window.height / 6 + line; y < window.br().y; y += line + line / 2) {
      const int indent = c.rng.uniform(0, window.width / 4 + 1);
      draw_text_line(c.tone, window.x + 3 + indent, window.br().x - c.rng.uniform(0, window.width / 3 + 1), y, line,
                     dark ? 225 : 25, c.rng);
    }
  }
  cv::rectangle(c.tone, {0, 0, c.tone.cols, c.tone.rows}, 5, 2 * c.px(0.012));
}

// Paints sky, houses and trees behind the bars of a window.
void window(Canvas& c) {
  const cv::Size s = c.size();
  for (int y = 0; y < s.height; ++y) {
    const int level = 255 - 50 * y / s.height;
    c.tone.row(y).setTo(level);
  }
  add_noise(c.tone, octave_noise(s, c.rng, s.height * 0.3, 0.6, 2), 20);
  for (int i = 0; i < 14; ++i) {
    const int w = static_cast<int>(s.width * c.rng.uniform(0.06, 0.2)),
              top = static_cast<int>(s.height * c.rng.uniform(0.3, 0.75));
    const cv::Rect house(c.rng.uniform(-w / 2, s.width), top, w, s.height - top);
    cv::rectangle(c.tone, house, c.rng.uniform(90, 200), cv::FILLED);
    cv::rectangle(c.accent, house, c.rng.uniform(40, 160), cv::FILLED);
    const int step = std::max(5, c.px(0.03));
    for (int y = house.y + step / 2; y < house.br().y; y += step)
      for (int x = house.x + step / 2; x + step / 2 < house.br().x; x += step)
        if (c.rng.uniform(0, 5))
          cv::rectangle(c.tone, {x, y, step / 2, step / 2}, c.rng.uniform(0, 2) ? 30 : 250, cv::FILLED);
  }
  cv::Mat trees = octave_noise(s, c.rng, s.height * 0.2, 0.8), mask;
  for (int y = 0; y < s.height; ++y) trees.row(y) += 2.2 * y / s.height - 2.1;
  mask = trees > 0;
  cv::Mat leaves(s, CV_8U, cv::Scalar(60));
  add_noise(leaves, octave_noise(s, c.rng, c.px(0.05), 0.9), 60);
  leaves.copyTo(c.tone, mask);
  c.accent.setTo(0, mask);
  const int bar = c.px(0.05);
  for (cv::Mat* layer : {&c.tone, &c.accent}) {
    const int ink = layer == &c.tone ? 150 : 250;
    cv::rectangle(*layer, {0, 0, s.width, s.height}, ink, 2 * bar);
    cv::line(*layer, {s.width / 2, 0}, {s.width / 2, s.height}, ink, bar);
    cv::line(*layer, {0, s.height * 2 / 5}, {s.width, s.height * 2 / 5}, ink, bar * 2 / 3);
  }
}

}  // namespace

void paint_print(Material material, Canvas& c) {
  if (material == Material::kPicture) return picture(c);
  if (material == Material::kScreen) return screen(c);
  if (material == Material::kWindow) return window(c);
  if (material == Material::kPaper) {
    c.tone.setTo(235);
    const cv::Rect r = inside(c, 0.08);
    if (r.width > 12 && r.height > 12) page(c, r);
    return;
  }
  poster(c);
}

}  // namespace rumi::synth
