// SPDX-License-Identifier: BSD-3-Clause
// Houses as triangles. Each house on the street has a façade of its own.
#include <algorithm>
#include <cmath>

#include "synth/street_build.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPicturesPx = 45e6;                       // of all façades together, at most
constexpr double kLowestPxPerM = 26, kHighestPxPerM = 50;  // of a façade
constexpr double kCell_m = 2.4;                            // light varies over a wall in such steps
constexpr double kEaves_m = 0.35;                          // how far a roof stands over

class HouseBuilder {
 public:
  HouseBuilder(const House& house, const StreetSite& site, double px_per_m, TextureAtlas* atlas,
               StreetMeshBuilder* mesh)
      : h_(house),
        f_(house.footprint),
        m_(site.models),
        rng_(rng_of(site.seed, kPictureChance, 1000 + house.number)),
        atlas_(*atlas),
        mesh_(*mesh),
        px_per_m_(px_per_m) {
    drawn_as_ = DrawnAs::kFar;
    colours_ = facade_palette(rng_);
  }

  void build() {
    const TextureAtlas::Patch& plain = pick(h_.remote ? m_.remote_walls : m_.walls, h_.number);
    const Surface side{plain, colours_};
    front(h_.remote ? plain
                    : atlas_.add(paint_facade({f_.width_m, h_.eaves_m, h_.storeys, true, h_.shop}, px_per_m_, rng_)));
    wall(f_.width_m, 0, f_.width_m, f_.depth_m, side);
    wall(f_.width_m, f_.depth_m, 0, f_.depth_m, side);
    wall(0, f_.depth_m, 0, 0, side);
    if (h_.ridge_m > 0)
      gable_roof(side);
    else
      flat_roof();
    if (!h_.remote) chimney();
  }

 private:
  Vector3d at(double along, double inward, double up) const {
    const Vector2d p = f_.at(along, inward);
    return {p.x(), p.y(), h_.floor_m + up};
  }

  // A wall from the floor to the eaves, which leads right as seen from outside, with its foot below.
  void wall(double a0, double i0, double a1, double i1, const Surface& surface) {
    const Vector3d from = at(a0, i0, h_.eaves_m), to = at(a1, i1, h_.eaves_m);
    const int n = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kCell_m)));
    const int m = std::max(1, static_cast<int>(std::ceil(h_.eaves_m / kCell_m)));
    const Vector3d u = (to - from) / n, v(0, 0, -h_.eaves_m / m);
    for (int i = 0; i < (h_.remote ? 1 : n); ++i)
      for (int j = 0; j < (h_.remote ? 1 : m); ++j) {
        Face face = h_.remote ? rectangle(from, to - from, {0, 0, -h_.eaves_m}, surface)
                              : rectangle(from + i * u + j * v, u, v, surface);
        if (!h_.remote)
          for (Corner& c : face.corners) c.u = (c.u + i) / n, c.v = (c.v + j) / m;
        mesh_.add(face, drawn_as_, h_.remote ? Shadow::kNone : Shadow::kBaked);
      }
    // The plinth repeats the lowest strip of a plain wall.
    Face foot =
        rectangle(at(a0, i0, 0), to - from, {0, 0, h_.foot_m - h_.floor_m}, {pick(m_.walls, h_.number + 3), plinth()});
    for (Corner& c : foot.corners) c.v = 0.97 + 0.03 * c.v;
    mesh_.add(foot, drawn_as_, Shadow::kMap);
  }

  Palette plinth() const { return {{30, 30, 30}, {150, 146, 140}, {60, 60, 60}}; }

  void front(const TextureAtlas::Patch& patch) { wall(0, 0, f_.width_m, 0, {patch, colours_}); }

  void gable_roof(const Surface& side) {
    const double w = f_.width_m, d = f_.depth_m, e = kEaves_m, top = h_.eaves_m + h_.ridge_m;
    const double slope = h_.ridge_m / (d / 2), low = h_.eaves_m - e * slope;
    const Surface tiles{pick(m_.roofs, h_.number), roof_palette(rng_)};
    const Vector3d along = at(w, 0, 0) - at(0, 0, 0);
    mesh_.add(rectangle(at(0, d / 2, top), along, at(0, -e, low) - at(0, d / 2, top), tiles), drawn_as_, Shadow::kNone);
    mesh_.add(rectangle(at(w, d / 2, top), -along, at(0, d + e, low) - at(0, d / 2, top), tiles), drawn_as_,
              Shadow::kNone);
    const double v = std::min(0.9, h_.ridge_m / h_.eaves_m);
    mesh_.add(Face{{{at(w, 0, h_.eaves_m), 0, v}, {at(w, d / 2, top), 0.5, 0}, {at(w, d, h_.eaves_m), 1, v}}, side},
              drawn_as_, Shadow::kNone);
    mesh_.add(Face{{{at(0, d, h_.eaves_m), 0, v}, {at(0, d / 2, top), 0.5, 0}, {at(0, 0, h_.eaves_m), 1, v}}, side},
              drawn_as_, Shadow::kNone);
    // The underside of the front eaves, which is seen from the street.
    mesh_.add(rectangle(at(0, -e, low - 0.03), along, at(0, 0, h_.eaves_m) - at(0, -e, low), {tiles.patch, plinth()}),
              drawn_as_, Shadow::kNone);
  }

  void flat_roof() {
    const Surface felt{pick(m_.tar, h_.number), {{60, 60, 62}, {140, 138, 134}, {0, 0, 0}}};
    mesh_.add(rectangle(at(0, f_.depth_m, h_.eaves_m), at(1, 0, 0) * f_.width_m - at(0, 0, 0) * f_.width_m,
                        at(0, 0, 0) - at(0, f_.depth_m, 0), felt),
              drawn_as_, Shadow::kNone);
  }

  void chimney() {
    const double a = rng_.uniform(0.1, 0.9) * f_.width_m, i = rng_.uniform(0.3, 0.6) * f_.depth_m;
    const double up = h_.eaves_m + (h_.ridge_m > 0 ? 0.8 * h_.ridge_m : 0.3);
    Model model;
    add_box({0, 0, 0}, {0.6, 0.9, 2.0}, {pick(m_.walls, h_.number + 5), {{40, 30, 28}, {178, 110, 84}, {60, 60, 60}}},
            false, &model);
    for (Face& face : model)
      for (Corner& c : face.corners) c.u = 0.02 + 0.06 * c.u, c.v = 0.86 + 0.12 * c.v;
    mesh_.add(model, drawn_as_, Shadow::kNone, standing(at(a, i, up), std::atan2(f_.along.y(), f_.along.x())));
  }

  const House& h_;
  const Footprint& f_;
  const StreetModels& m_;
  cv::RNG rng_;
  TextureAtlas& atlas_;
  StreetMeshBuilder& mesh_;
  double px_per_m_;
  DrawnAs drawn_as_;
  Palette colours_;
};

}  // namespace

void build_houses(const StreetSite& site, TextureAtlas* atlas, StreetMeshBuilder* mesh) {
  double area_m2 = 1;
  for (const House& house : site.plan.houses)
    if (!house.remote) area_m2 += house.footprint.width_m * house.eaves_m;
  const double px_per_m = std::clamp(std::sqrt(kPicturesPx / area_m2), kLowestPxPerM, kHighestPxPerM);
  for (const House& house : site.plan.houses) HouseBuilder(house, site, px_per_m, atlas, mesh).build();
}

}  // namespace rumi::synth
