// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_models.h"

#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

const Palette kGlass{{10, 12, 14}, {196, 214, 226}, {200, 40, 30}};
const Palette kRubber{{14, 14, 15}, {190, 192, 196}, {0, 0, 0}};

Vector3d point(const cv::Point2d& p, double y) { return {p.x, y, p.y}; }

// One side of a car: a fan around the middle of its lower edge, so that the outline may be hollow.
Face car_side(const CarShape& shape, const TextureAtlas::Patch& patch, double side) {
  Face face{.surface = {patch, {}}, .painted = true};
  const auto corner = [&](double x, double z) {
    return Corner{{x, side * shape.half_width_m, z}, x / shape.length_m + 0.5, 1 - z / shape.height_m};
  };
  face.corners.push_back(corner(0, shape.outline.front().y));
  for (size_t i = 0; i < shape.outline.size(); ++i) {
    const cv::Point2d& p = shape.outline[side < 0 ? i : shape.outline.size() - 1 - i];
    face.corners.push_back(corner(p.x, p.y));
  }
  return face;
}

void add_wheels(const CarShape& shape, const TextureAtlas::Patch& patch, Model* model) {
  constexpr double kRadius_m = 0.31;
  constexpr int kSides = 10;
  for (const double axle : shape.axles_m)
    for (const double side : {-1.0, 1.0}) {
      Face face{.surface = {patch, kRubber}};
      for (int i = 0; i < kSides; ++i) {
        const double a = side * 2 * M_PI * i / kSides;  // clockwise as seen from that side
        face.corners.push_back(
            {{axle + kRadius_m * std::cos(a), side * (shape.half_width_m + 0.015), kRadius_m + kRadius_m * std::sin(a)},
             0.5 + 0.5 * std::cos(a),
             0.5 - 0.5 * std::sin(a)});
      }
      model->push_back(face);
    }
}

}  // namespace

StreetModels::StreetModels(uint64_t seed, TextureAtlas* atlas) {
  paint_all(seed, atlas);
  build_cars(seed, atlas);
  build_lorry(seed, atlas);
  build_trees(seed);
}

void StreetModels::paint_all(uint64_t seed, TextureAtlas* atlas) {
  cv::RNG rng = rng_of(seed, kPictureChance, 1);
  asphalt = atlas->add_layer(paint_asphalt(rng));
  paving = atlas->add_layer(paint_paving(rng));
  lawn = atlas->add_layer(paint_lawn(rng));
  const auto fill = [&](std::vector<TextureAtlas::Patch>& list, int count, const auto& paint_one) {
    for (int i = 0; i < count; ++i) list.push_back(atlas->add(paint_one()));
  };
  fill(walls, 14, [&] { return paint_facade({9, 8, 3, false, false}, 26, rng); });
  fill(remote_walls, 24, [&] {
    const int storeys = rng.uniform(2, 6);
    return paint_facade({12, 2.9 * storeys, storeys, false, false}, 14, rng);
  });
  fill(roofs, 10, [&] { return paint_roof({260, 180}, 26, rng); });
  fill(leaves, 8, [&] { return paint_leaves(rng); });
  fill(hedges, 8, [&] { return paint_hedge(rng); });
  fill(fences, 8, [&] { return paint_fence(rng); });
  fill(signs, 10, [&] { return paint_sign(rng); });
  fill(markings, 10, [&] { return paint_marking(rng); });
  fill(manholes, 8, [&] { return paint_manhole(rng); });
  fill(tar, 16, [&] { return paint_patch_of_tar(rng); });
  fill(bark, 4, [&] { return paint(Material::kWood, {32, 160}, 60, rng); });
  fill(metal, 4, [&] { return paint(Material::kPlaster, {24, 400}, 60, rng); });
  fill(person.cloth, 12, [&] { return paint(Material::kCloth, {40, 60}, 90, rng); });
  person.skin = atlas->add(paint(Material::kPlaster, {24, 24}, 90, rng));
}

void StreetModels::build_cars(uint64_t seed, TextureAtlas* atlas) {
  for (int i = 0; i < 2 * kCarShapes; ++i) {
    cv::RNG rng = rng_of(seed, kPictureChance, 100 + static_cast<uint64_t>(i));
    const CarShape shape = car_shape(i % kCarShapes);
    const TextureAtlas::Patch side = atlas->add(paint_car_side(shape, rng)), glass = atlas->add(paint_glass(rng)),
                              front = atlas->add(paint_car_end(false, rng)),
                              back = atlas->add(paint_car_end(true, rng)), wheel = atlas->add(paint_wheel(rng));
    Model model;
    for (const double left : {-1.0, 1.0}) model.push_back(car_side(shape, side, left));
    const Vector3d across(0, -2 * shape.half_width_m, 0);
    const size_t n = shape.outline.size();
    for (size_t k = 0; k + 1 < n; ++k) {
      const cv::Point2d a = shape.outline[k], b = shape.outline[k + 1];
      const Vector3d low = point(a, shape.half_width_m), high = point(b, shape.half_width_m);
      const bool steep = std::abs(b.y - a.y) > 0.33, window = steep && std::max(a.y, b.y) > 1.3;
      const bool end = std::abs(b.x - a.x) < 0.1 || (k + 2 == n);
      const Surface surface{window ? glass : end ? (k < n / 2 ? back : front) : side, window ? kGlass : Palette{}};
      // Seen from outside, a rear face has its left side at +y, and a front face at -y.
      const bool rear = b.y > a.y;
      Face face = rear ? rectangle(high, across, low - high, surface, !window)
                       : rectangle(low + across, -across, high - low, surface, !window);
      if (!window && !end)
        for (Corner& corner : face.corners) corner.u = 0.5, corner.v = 0.42 + 0.1 * corner.v;  // plain paint
      model.push_back(face);
    }
    add_wheels(shape, wheel, &model);
    const Surface dark{wheel, {{6, 6, 7}, {16, 16, 17}, {6, 6, 7}}};
    add_box({0, 0, 0.24}, {0.96 * shape.length_m, 1.7 * shape.half_width_m, 0.3}, dark, false, &model);
    cars.push_back({model, shape.length_m});
  }
}

void StreetModels::build_lorry(uint64_t seed, TextureAtlas* atlas) {
  cv::RNG rng = rng_of(seed, kPictureChance, 200);
  const double w = kLorryWidth_m, h = kLorryHeight_m - 0.5, l = kLorry_m;
  const Palette colours{{25, 28, 34}, {226, 226, 220}, {30, 70, 150}};
  const Surface side{atlas->add(paint_lorry({l, h}, false, rng)), colours},
      back{atlas->add(paint_lorry({w, h}, true, rng)), colours};
  const double top = kLorryHeight_m;
  lorry.push_back(rectangle({0, w / 2, top}, {0, -w, 0}, {0, 0, -h}, back));
  lorry.push_back(rectangle({l, -w / 2, top}, {0, w, 0}, {0, 0, -h}, back));
  lorry.push_back(rectangle({0, -w / 2, top}, {l, 0, 0}, {0, 0, -h}, side));
  lorry.push_back(rectangle({l, w / 2, top}, {-l, 0, 0}, {0, 0, -h}, side));
  lorry.push_back(rectangle({0, w / 2, top}, {l, 0, 0}, {0, -w, 0}, side));
  const Surface dark{back.patch, {{8, 8, 9}, {46, 46, 48}, {60, 60, 60}}};
  for (const double x : {1.6, 6.8}) add_box({x, 0, 0.4}, {1.0, w - 0.1, 0.8}, dark, false, &lorry);
}

// A trunk, and clouds of leaves around the middle of the crown.
void StreetModels::build_trees(uint64_t seed) {
  for (int i = 0; i < 6; ++i) {
    cv::RNG rng = rng_of(seed, kPictureChance, 300 + static_cast<uint64_t>(i));
    Model tree;
    for (int k = 0; k < 36; ++k) {
      const double z = rng.uniform(-1.0, 1.0), angle = k * 2.4 + rng.uniform(-0.3, 0.3), r = std::sqrt(1 - z * z);
      const Vector3d out(r * std::cos(angle), r * std::sin(angle), z);
      const double deep = rng.uniform(0.55, 1.0), side = rng.uniform(0.2, 0.3);
      const Vector3d middle = Vector3d(0, 0, 0.66) + deep * Vector3d(0.2 * out.x(), 0.2 * out.y(), 0.27 * out.z());
      const double yaw = rng.uniform(0.0, M_PI), tilt = rng.uniform(-0.7, 0.7);
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
      const Vector3d u = turn * Vector3d(side, 0, 0), v = turn * Vector3d(0, 0, -side);
      const Surface surface{leaves[static_cast<size_t>(rng.uniform(0, static_cast<int>(leaves.size())))], {}};
      tree.push_back(rectangle(middle - 0.5 * (u + v), u, v, surface, true));
      tree.push_back(rectangle(middle - 0.5 * (v - u), -u, v, surface, true));
    }
    trees.push_back(tree);
  }
}

Model person(const PersonPictures& pictures, double height_m, double phase, uint64_t number) {
  cv::RNG rng(number * 7919 + 13);
  const Surface coat{pick(pictures.cloth, number), random_palette(Material::kCloth, rng)};
  Surface trousers{pick(pictures.cloth, number / 3 + 5), random_palette(Material::kCloth, rng)};
  for (int k = 0; k < 3; ++k) trousers.palette.light[k] = static_cast<uchar>(trousers.palette.light[k] / 2);
  const Surface skin{pictures.skin, {{110, 70, 52}, {226, 176, 146}, {60, 40, 30}}};
  const Surface hair{pictures.skin, {{20, 16, 14}, {110, 84, 60}, {20, 20, 20}}};
  Model model;
  const auto limb = [&](const Vector3d& joint, double length, double thick, double swing_rad, const Surface& surface) {
    const size_t first = model.size();
    add_box({0, 0, -length / 2}, {thick, thick, length}, surface, false, &model);
    move_faces({Eigen::Quaterniond(Eigen::AngleAxisd(swing_rad, Vector3d::UnitY())), joint}, first, &model);
  };
  const double swing = 0.5 * std::sin(2 * M_PI * phase);
  for (const double side : {-1.0, 1.0}) {
    limb({0, 0.09 * side, 0.86}, 0.86, 0.15, side * swing, trousers);
    limb({0, 0.25 * side, 1.42}, 0.62, 0.1, -side * swing, coat);
  }
  add_box({0, 0, 1.15}, {0.26, 0.42, 0.62}, coat, false, &model);
  add_box({0, 0, 1.6}, {0.19, 0.17, 0.24}, skin, false, &model);
  add_box({-0.02, 0, 1.7}, {0.22, 0.2, 0.12}, hair, false, &model);
  for (Face& face : model)
    for (Corner& corner : face.corners) corner.at *= height_m / 1.76;
  return model;
}

}  // namespace rumi::synth
