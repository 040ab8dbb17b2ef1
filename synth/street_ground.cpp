// SPDX-License-Identifier: BSD-3-Clause
// The ground as triangles: road, kerb, pavement and lawn, cut along lines of equal distance from the route.
#include <algorithm>
#include <cmath>

#include "synth/street_build.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kKerbStone_m = 0.18;
constexpr double kLawnReach_m = 36;  // beyond, the ground has large triangles
constexpr double kFarCell_m = 32, kFarMargin_m = 420;
constexpr double kMark_m = 0.02;  // marks are higher than the road by this, so that they are not hidden by it

// A corner of a cell, with its distance from the route.
struct Node {
  Vector3d at;
  double distance_m;
};

Node between(const Node& a, const Node& b, double distance_m) {
  const double u = (distance_m - a.distance_m) / (b.distance_m - a.distance_m);
  return {a.at + u * (b.at - a.at), distance_m};
}

// Keeps the part of a polygon whose distance is at least (`sign` 1) or at most (-1) `distance_m`.
std::vector<Node> cut(const std::vector<Node>& polygon, double distance_m, double sign) {
  std::vector<Node> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Node &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const bool in_a = sign * (a.distance_m - distance_m) >= 0, in_b = sign * (b.distance_m - distance_m) >= 0;
    if (in_a) kept.push_back(a);
    if (in_a != in_b) kept.push_back(between(a, b, distance_m));
  }
  return kept;
}

class GroundBuilder {
 public:
  GroundBuilder(const StreetSite& site, StreetMeshBuilder* mesh) : field_(site.field), style_(site.style), mesh_(mesh) {
    cv::RNG rng = rng_of(site.seed, kGroundChance, 0);
    const auto grey = [&](int level) {
      const uchar v = cv::saturate_cast<uchar>(level + rng.uniform(-6, 7));
      return cv::Vec3b(v, v, cv::saturate_cast<uchar>(v + rng.uniform(-3, 6)));
    };
    road_ = {site.models.asphalt, {grey(28), grey(176), grey(120)}};
    pavement_ = {site.models.paving, {grey(40), grey(205), {90, 104, 66}}};
    kerb_ = {site.models.paving, {grey(70), grey(232), grey(120)}};
    lawn_ = {site.models.lawn, {{26, 40, 16}, {126, 156, 78}, {168, 150, 100}}};
  }

  void build() {
    for (int y = 0; y < field_.rows(); ++y)
      for (int x = 0; x < field_.columns(); ++x) {
        const Node a = node(x, y), b = node(x + 1, y), c = node(x, y + 1), d = node(x + 1, y + 1);
        if (std::min({a.distance_m, b.distance_m, c.distance_m, d.distance_m}) > kLawnReach_m) continue;
        // Clockwise as seen from above; StreetField::ground_m() divides the cells along the same diagonal.
        triangle({a, c, b});
        triangle({b, c, d});
      }
    far_ground();
  }

 private:
  Node node(int x, int y) const {
    const Vector2d at = field_.low() + StreetField::kCell_m * Vector2d(x, y);
    // The point at a cell's corner is taken a little inside the grid, where it has a height.
    return {{at.x(), at.y(), field_.ground_m(at)}, field_.distance_m(at)};
  }

  void triangle(const std::vector<Node>& corners) {
    const double kerb = style_.kerb_m, stone = kerb + kKerbStone_m, edge = style_.pavement_m,
                 rise = style_.kerb_height_m;
    zone(cut(corners, kerb, -1), road_, 0);
    const std::vector<Node> beyond = cut(corners, kerb, 1);
    if (rise > 0) {
      zone(cut(beyond, stone, -1), kerb_, rise);
      kerb_front(corners);
    }
    const std::vector<Node> paved = rise > 0 ? cut(beyond, stone, 1) : beyond;
    zone(cut(paved, edge, -1), pavement_, rise);
    zone(cut(beyond, edge, 1), lawn_, rise);
  }

  void zone(const std::vector<Node>& polygon, const Surface& surface, double rise) {
    if (polygon.size() < 3) return;
    constexpr double kPeriod_m = TextureAtlas::kSize / kGroundPxPerM;
    Face face{.surface = surface};
    for (const Node& n : polygon)
      face.corners.push_back({n.at + rise * Vector3d::UnitZ(), n.at.x() / kPeriod_m, n.at.y() / kPeriod_m});
    mesh_->add(face, DrawnAs::kGround, Shadow::kMap);
  }

  // The upright side of the kerb, which faces the road.
  void kerb_front(const std::vector<Node>& corners) {
    std::vector<Vector3d> ends;
    for (size_t i = 0; i < 3; ++i) {
      const Node &a = corners[i], &b = corners[(i + 1) % 3];
      if ((a.distance_m >= style_.kerb_m) != (b.distance_m >= style_.kerb_m))
        ends.push_back(between(a, b, style_.kerb_m).at);
    }
    if (ends.size() != 2) return;
    // Seen from the road, the left end comes first.
    const Node* high = &*std::max_element(corners.begin(), corners.end(),
                                          [](const Node& a, const Node& b) { return a.distance_m < b.distance_m; });
    const Vector3d across = ends[1] - ends[0], away = high->at - ends[0];
    if (across.x() * away.y() - across.y() * away.x() < 0) std::swap(ends[0], ends[1]);
    const Vector3d top(0, 0, style_.kerb_height_m);
    mesh_->add(
        Face{{{ends[0] + top, 0.3, 0.1}, {ends[1] + top, 0.31, 0.1}, {ends[1], 0.31, 0.104}, {ends[0], 0.3, 0.104}},
             kerb_},
        DrawnAs::kGround, Shadow::kMap);
  }

  // Large triangles, slightly below the small ones.
  void far_ground() {
    const Vector2d from = field_.low().array() - kFarMargin_m, to = field_.high().array() + kFarMargin_m;
    constexpr double kPeriod_m = TextureAtlas::kSize / kGroundPxPerM;
    const auto corner = [&](double x, double y) {
      const Vector2d at(x, y);
      const double below =
          field_.distance_m(at) < kLawnReach_m + kFarCell_m * 1.5 && field_.distance_m(at) < StreetField::kReach_m
              ? 1.5
              : 0.4;
      return Corner{{x, y, field_.ground_m(at) - below}, x / kPeriod_m, y / kPeriod_m};
    };
    for (double y = from.y(); y < to.y(); y += kFarCell_m)
      for (double x = from.x(); x < to.x(); x += kFarCell_m)
        mesh_->add(Face{{corner(x, y), corner(x, y + kFarCell_m), corner(x + kFarCell_m, y + kFarCell_m),
                         corner(x + kFarCell_m, y)},
                        lawn_},
                   DrawnAs::kFar, Shadow::kNone);
  }

  const StreetField& field_;
  const StreetStyle& style_;
  StreetMeshBuilder* mesh_;
  Surface road_, pavement_, kerb_, lawn_;
};

// Lays a picture on the road, in pieces that follow the ground. Its length is along the yaw.
void lay(const StreetSite& site, const Place& place, double left_m, double width_m, const Surface& surface,
         StreetMeshBuilder* mesh) {
  const double length_m = place.size_m;
  const Vector2d t(std::cos(place.yaw_rad), std::sin(place.yaw_rad)), left(-t.y(), t.x());
  const auto corner = [&](double u, double v) {
    const Vector2d at = place.at + (u - 0.5) * length_m * t + (left_m + (0.5 - v) * width_m) * left;
    return Corner{{at.x(), at.y(), site.field.ground_m(at) + kMark_m}, u, v};
  };
  const int n = std::max(1, static_cast<int>(std::ceil(length_m / 0.8))),
            m = std::max(1, static_cast<int>(std::ceil(width_m / 0.8)));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u0 = double(i) / n, u1 = double(i + 1) / n, v0 = double(j) / m, v1 = double(j + 1) / m;
      mesh->add(Face{{corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)}, surface}, DrawnAs::kMarks,
                Shadow::kMap);
    }
}

}  // namespace

void build_ground(const StreetSite& site, StreetMeshBuilder* mesh) { GroundBuilder(site, mesh).build(); }

void build_marks(const StreetSite& site, StreetMeshBuilder* mesh) {
  const StreetModels& m = site.models;
  const Palette white{{90, 90, 90}, {250, 250, 246}, {0, 0, 0}}, iron{{16, 16, 17}, {150, 146, 140}, {0, 0, 0}},
      tar{{24, 24, 26}, {150, 150, 152}, {0, 0, 0}};
  for (const Place& p : site.plan.patches) lay(site, p, 0, 0.35 + 0.4 * p.size_m, {pick(m.tar, p.number), tar}, mesh);
  for (const Place& p : site.plan.dashes) lay(site, p, 0, 0.14, {pick(m.markings, p.number), white}, mesh);
  for (const Place& p : site.plan.zebras)
    for (int k = -4; k <= 4; ++k)
      if (std::abs(k) * 1.0 < site.style.kerb_m - 0.5)
        lay(site, p, k, 0.5, {pick(m.markings, p.number + static_cast<uint64_t>(k + 4)), white}, mesh);
  for (const Place& p : site.plan.manholes) lay(site, p, 0, p.size_m, {pick(m.manholes, p.number), iron}, mesh);
}

}  // namespace rumi::synth
