// SPDX-License-Identifier: BSD-3-Clause
#include "synth/furniture.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

SE3 turned(const SE3& room_from_local, const Vector3d& at, double yaw_rad) {
  return room_from_local * SE3(so3_exp({0, 0, yaw_rad}), at);
}

void add_legs(MeshBuilder& b, const SE3& frame, double width, double depth, double height, const Look& wood) {
  const double t = 0.045;
  for (const double x : {-0.5, 0.5})
    for (const double y : {0.0, 1.0})
      b.box(frame, {x * (width - 1.5 * t), t + y * (depth - 2 * t), height / 2}, {t, t, height}, wood);
}

// Fills a board at height z with books side by side from x0 to x1, with gaps, boxes, lying books and other things.
void fill_shelf(MeshBuilder& b, const SE3& frame, double x0, double x1, double depth, double z, double room_above) {
  double x = x0;
  while (x < x1 - 0.03) {
    const double choice = b.uniform(0, 1);
    if (choice < 0.06) {
      x += b.uniform(0.03, 0.12);
    } else if (choice < 0.16 && x1 - x > 0.16) {  // a box
      const double w = std::min(b.uniform(0.12, 0.26), x1 - x), h = room_above * b.uniform(0.4, 0.85);
      b.box(frame, {x + w / 2, depth * 0.52, z + h / 2}, {w * 0.95, depth * 0.8, h}, b.look(Material::kCardboard));
      x += w;
    } else if (choice < 0.24 && x1 - x > 0.26) {  // lying books
      double top = z;
      for (int k = b.rng.uniform(2, 6); k > 0 && top < z + room_above - 0.06; --k) {
        const double h = b.uniform(0.015, 0.045);
        b.box(turned(frame, {x + 0.12, depth * 0.55, 0}, b.uniform(-0.15, 0.15)), {0, 0, top + h / 2},
              {b.uniform(0.17, 0.23), depth * 0.7, h}, b.look(Material::kBook));
        top += h;
      }
      x += 0.25;
    } else if (choice < 0.29 && x1 - x > 0.14) {
      const double h = std::min(room_above * 0.8, b.uniform(0.1, 0.22));
      b.box(frame, {x + 0.06, depth * 0.5, z + h / 2}, {0.1, 0.1, h}, b.look(Material::kPot));
      x += 0.13;
    } else {
      const double w = b.uniform(0.018, 0.055), h = room_above * b.uniform(0.6, 0.95), d = depth * b.uniform(0.6, 0.85);
      b.box(frame, {x + w / 2, 0.03 + d / 2, z + h / 2}, {w * 0.96, d, h}, b.look(Material::kBook));
      x += w;
    }
  }
}

void desk_lamp(MeshBuilder& b, const SE3& frame, const Vector3d& at, double height) {
  const Look metal = b.look(Material::kPot);
  b.box(frame, at + Vector3d(0, 0, 0.01), {0.14, 0.14, 0.02}, metal);
  b.box(frame, at + Vector3d(0, 0, height / 2), {0.02, 0.02, height}, metal);
  b.box(frame, at + Vector3d(0, 0.06, height), {0.12, 0.2, 0.07}, b.look(Material::kCloth), true);
}

void monitor(MeshBuilder& b, const SE3& frame, const Vector3d& at, double height) {
  const Look shell = b.look(Material::kWood);
  const double w = height * 1.35;
  b.box(frame, at + Vector3d(0, 0, 0.012), {w * 0.4, 0.18, 0.024}, shell);
  b.box(frame, at + Vector3d(0, -0.03, height * 0.55), {w, 0.04, height * 0.85}, shell);
  b.quad(frame, at + Vector3d(w * 0.48, -0.006, height * 0.95), {-w * 0.96, 0, 0}, {0, 0, -height * 0.8},
         b.look(Material::kScreen));
}

// Puts papers and boxes on a flat top of `width` by `depth` at height z. They are at most `limit` high.
void clutter(MeshBuilder& b, const SE3& frame, double width, double depth, double z, double limit) {
  for (int k = static_cast<int>(8 * width * depth) + 3; k > 0; --k) {  // papers
    const SE3 f = turned(frame, {b.uniform(-0.4, 0.4) * width, b.uniform(0.2, 0.8) * depth, z + 0.002 + 0.0007 * k},
                         b.uniform(-2, 2));
    b.quad(f, {-0.105, 0.148, 0}, {0.21, 0, 0}, {0, -0.297, 0}, b.look(Material::kPaper));
  }
  double x = -width / 2 + 0.03;
  while (x < width / 2 - 0.12) {
    const double y = b.uniform(0.12, 0.8) * depth, yaw = b.uniform(-0.6, 0.6), choice = b.uniform(0, 1);
    if (choice < 0.35) {
      const double w = b.uniform(0.1, std::min(0.32, width / 3)), h = std::min(limit, b.uniform(0.06, 0.3));
      b.box(turned(frame, {x + w / 2, y, 0}, yaw), {0, 0, z + h / 2}, {w, b.uniform(0.1, 0.25), h},
            b.look(Material::kCardboard));
      x += w;
    } else if (choice < 0.65) {
      double top = z;
      for (int k = b.rng.uniform(1, 7); k > 0 && top < z + limit - 0.05; --k) {
        const double h = b.uniform(0.015, 0.05);
        b.box(turned(frame, {x + 0.1, y, 0}, yaw + b.uniform(-0.3, 0.3)), {0, 0, top + h / 2}, {0.16, 0.22, h},
              b.look(Material::kBook));
        top += h;
      }
      x += 0.2;
    } else if (choice < 0.75 && limit > 0.35) {
      desk_lamp(b, frame, {x + 0.08, y, z}, std::min(limit - 0.05, b.uniform(0.3, 0.45)));
      x += 0.16;
    } else if (choice < 0.87 && limit > 0.38 && x < width / 2 - 0.5) {
      monitor(b, turned(frame, {x + 0.25, 0.35 * depth, z}, b.uniform(-0.25, 0.25)), {0, 0, 0}, std::min(limit, 0.4));
      x += 0.52;
    } else {
      const double h = std::min(limit, b.uniform(0.08, 0.2)), w = b.uniform(0.06, 0.12);
      b.box(turned(frame, {x + w / 2, y, 0}, yaw), {0, 0, z + h / 2}, {w, w, h}, b.look(Material::kPot));
      x += w;
    }
    x += b.uniform(0.0, 0.08);
  }
}

}  // namespace

void add_bookcase(MeshBuilder& b, const SE3& f, double width, double depth, double height) {
  const Look wood = b.look(Material::kWood);
  const double t = 0.025;
  b.begin_part(true);
  b.box(f, {0, t / 2, height / 2}, {width, t, height}, wood);
  for (const double side : {-0.5, 0.5}) b.box(f, {side * (width - t), depth / 2, height / 2}, {t, depth, height}, wood);
  const int boards = std::max(2, static_cast<int>(height / b.uniform(0.3, 0.4)));
  const double pitch = (height - t) / boards;
  for (int k = 0; k <= boards; ++k)
    b.box(f, {0, depth / 2, t / 2 + k * pitch}, {width - 2 * t, depth - 0.005, t}, wood, true);
  for (int k = 0; k < boards; ++k) {
    b.begin_part();
    fill_shelf(b, f, -width / 2 + t, width / 2 - t, depth, t + k * pitch, pitch - t - 0.01);
  }
}

void add_table(MeshBuilder& b, const SE3& f, double width, double depth, double height, double clutter_height) {
  const Look wood = b.look(Material::kWood);
  b.begin_part(true);
  add_legs(b, f, width, depth, height - 0.03, wood);
  b.box(f, {0, depth / 2, height - 0.015}, {width, depth, 0.03}, wood, true);
  b.begin_part();
  clutter(b, f, width, depth, height, clutter_height);
}

void add_cabinet(MeshBuilder& b, const SE3& f, double width, double depth, double height, double clutter_height) {
  const Look wood = b.look(Material::kWood), knob = b.look(Material::kPot);
  b.begin_part(true);
  b.box(f, {0, depth / 2, height / 2}, {width, depth, height}, wood);
  const int columns = std::max(1, static_cast<int>(width / 0.45)), rows = std::max(1, static_cast<int>(height / 0.35));
  const double w = width / columns, h = (height - 0.08) / rows;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double x = -width / 2 + (c + 0.5) * w, z = 0.06 + (r + 0.5) * h;
      b.box(f, {x, depth + 0.008, z}, {w - 0.02, 0.016, h - 0.02}, wood);
      b.box(f, {x, depth + 0.03, z + h * 0.25}, {0.08, 0.03, 0.02}, knob);
    }
  b.begin_part();
  if (clutter_height > 0.05) clutter(b, f, width, depth, height, clutter_height);
}

void add_box_stack(MeshBuilder& b, const SE3& f, double width, double depth, double height) {
  b.begin_part(true);
  double top = 0;
  while (top < height - 0.1) {
    const double h = std::min(b.uniform(0.18, 0.45), height - top), shrink = b.uniform(0.7, 0.95);
    b.box(turned(f, {b.uniform(-0.03, 0.03), depth / 2, 0}, b.uniform(-0.12, 0.12)), {0, 0, top + h / 2},
          {width * shrink, depth * shrink, h}, b.look(Material::kCardboard));
    top += h;
  }
}

void add_chair(MeshBuilder& b, const SE3& f, double width, double depth, double height) {
  const Look wood = b.look(Material::kWood), cloth = b.look(Material::kCloth);
  const double seat = 0.5 * height;
  b.begin_part(true);
  add_legs(b, f, width, depth, seat, wood);
  b.box(f, {0, depth / 2, seat + 0.025}, {width, depth, 0.05}, cloth, true);
  for (const double side : {-0.5, 0.5})
    b.box(f, {side * (width - 0.04), 0.02, (seat + height) / 2}, {0.035, 0.035, height - seat}, wood);
  b.box(f, {0, 0.02, height - 0.14}, {width, 0.03, 0.26}, cloth, true);
}

void add_plant(MeshBuilder& b, const SE3& f, double width, double height) {
  const double pot = std::min(0.32, 0.35 * height);
  b.begin_part(true);
  b.box(f, {0, width / 2, pot / 2}, {0.6 * width, 0.6 * width, pot}, b.look(Material::kPot));
  b.begin_part();
  const Look green = b.look(Material::kLeaf);
  std::vector<TextureAtlas::Patch> patches;
  patches.reserve(14);
  for (int k = 0; k < 14; ++k) patches.push_back(b.paint_patch(green, 0.2, 0.09));
  for (int k = static_cast<int>(70 * std::max(0.6, height)); k > 0; --k) {
    const double z = b.uniform(pot, 0.92 * height), angle = b.uniform(0, 2 * M_PI), rise = b.uniform(-0.2, 0.7);
    const double length = std::min(0.5 * width, b.uniform(0.12, 0.32)),
                 start = b.uniform(0, std::max(0.01, 0.5 * width - length));
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Vector3d along = length * Vector3d(out.x(), out.y(), rise).normalized();
    const Vector3d across =
        b.uniform(0.3, 0.5) * length * Vector3d(-out.y(), out.x(), b.uniform(-0.5, 0.5)).normalized();
    b.leaf(f, Vector3d(0, width / 2, z) + start * out, along, across, patches[b.rng.uniform(0, 14)],
           random_palette(Material::kLeaf, b.rng));
  }
}

void add_floor_lamp(MeshBuilder& b, const SE3& f, double width, double height) {
  const Look metal = b.look(Material::kPot);
  b.begin_part(true);
  b.box(f, {0, width / 2, 0.015}, {0.7 * width, 0.7 * width, 0.03}, metal);
  b.box(f, {0, width / 2, height / 2}, {0.03, 0.03, height}, metal);
  b.begin_part(false, 1.1f);
  b.box(f, {0, width / 2, height - 0.16}, {width, width, 0.3}, b.look(Material::kWallpaper), true);
}

void add_door(MeshBuilder& b, const SE3& f, double width, double depth, double height) {
  const Look frame = b.look(Material::kWood), metal = b.look(Material::kPot);
  b.begin_part(true);
  for (const double side : {-0.5, 0.5})
    b.box(f, {side * (width - 0.06), depth / 2, height / 2}, {0.06, depth, height}, frame);
  b.box(f, {0, depth / 2, height - 0.03}, {width, depth, 0.06}, frame);
  b.box(f, {0, depth / 4, height / 2}, {width - 0.12, depth / 2, height}, b.look(Material::kPanelling));
  b.box(f, {0.35 * width, 0.9 * depth, 1.05}, {0.12, 0.04, 0.03}, metal);
  b.begin_part(true);
  b.quad(f, {0.15, 0.6 * depth, 1.7}, {-0.3, 0, 0}, {0, 0, -0.2}, b.look(Material::kPoster));
}

void add_pillar(MeshBuilder& b, const SE3& f, double width, double height) {
  b.begin_part(true);
  b.box(f, {0, width / 2, height / 2}, {width, width, height},
        b.look(b.rng.uniform(0, 2) ? Material::kStone : Material::kBrick));
  b.begin_part(true);
  for (int k = 0; k < 4; ++k)
    b.quad(turned(f, {0, width / 2, 0}, k * M_PI / 2),
           {0.35 * width, width / 2 + 0.006, b.uniform(1.5, std::max(1.6, height - 0.4))}, {-0.7 * width, 0, 0},
           {0, 0, -width}, b.look(Material::kPoster));
}

}  // namespace rumi::synth
