// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_consensus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "slam/geometry/alignment.h"

namespace rumi::map_server {
namespace {

constexpr double kMissProbability = 1e-4;  // of no sample of three right pairs among those drawn

class Ransac {
 public:
  Ransac(const std::vector<PlaceEquation>& equations, const std::vector<int>& among, const Camera& camera_a,
         const Camera& camera_b, double max_error_px)
      : equations_(equations), among_(among), camera_a_(camera_a), camera_b_(camera_b), max_error_px_(max_error_px) {}

  std::optional<Consensus> run(int iterations) {
    if (among_.size() < 3) return std::nullopt;
    Consensus best;
    std::mt19937 rng(4711);  // fixed: the same answer every time
    for (int i = 0; i < iterations; ++i) {
      const auto b_from_a = propose(&rng);
      if (!b_from_a) continue;
      Consensus found = score(*b_from_a);
      if (found.members.size() <= best.members.size()) continue;
      best = std::move(found);
      iterations = std::min(iterations, needed(best.members.size()));
    }
    if (best.members.size() < 3) return std::nullopt;
    return best;
  }

 private:
  std::optional<Sim3> fit(const std::vector<int>& members) const {
    std::vector<Eigen::Vector3d> from, to;
    for (int i : members) {
      from.push_back(equations_[i].point_a);
      to.push_back(equations_[i].point_b);
    }
    auto b_from_a = umeyama(from, to);
    if (b_from_a && !(b_from_a->is_finite() && b_from_a->inverse().is_finite())) b_from_a.reset();
    return b_from_a;
  }

  bool agrees(int i, const Sim3& b_from_a, const Sim3& a_from_b) const {
    return reprojection_error_px(equations_[i], camera_a_, camera_b_, b_from_a, a_from_b) <= max_error_px_;
  }

  // Three pairs that agree with what they propose, which pairs with one wrong among them rarely do.
  std::optional<Sim3> propose(std::mt19937* rng) const {
    const size_t n = among_.size();
    const std::array<size_t, 3> draw{(*rng)() % n, (*rng)() % n, (*rng)() % n};
    if (draw[0] == draw[1] || draw[0] == draw[2] || draw[1] == draw[2]) return std::nullopt;
    const std::vector<int> sample{among_[draw[0]], among_[draw[1]], among_[draw[2]]};
    const auto b_from_a = fit(sample);
    if (!b_from_a) return std::nullopt;
    const Sim3 a_from_b = b_from_a->inverse();
    for (int i : sample)
      if (!agrees(i, *b_from_a, a_from_b)) return std::nullopt;
    return b_from_a;
  }

  Consensus score(const Sim3& b_from_a) const {
    Consensus result{b_from_a, {}};
    const Sim3 a_from_b = b_from_a.inverse();
    for (int i : among_)
      if (agrees(i, b_from_a, a_from_b)) result.members.push_back(i);
    return result;
  }

  int needed(size_t members) const {
    const double share = static_cast<double>(members) / static_cast<double>(among_.size());
    const double right = std::min(share * share * share, 1 - 1e-9);
    return static_cast<int>(std::min(1e9, std::ceil(std::log(kMissProbability) / std::log1p(-right))));
  }

  const std::vector<PlaceEquation>& equations_;
  const std::vector<int>& among_;
  const Camera& camera_a_;
  const Camera& camera_b_;
  const double max_error_px_;
};

}  // namespace

std::vector<PlaceEquation> make_equations(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b,
                                          const std::vector<PlaceMatch>& matches) {
  std::vector<PlaceEquation> equations;
  equations.reserve(matches.size());
  const double factor_a = a.submap->pyramid.scale_factor, factor_b = b.submap->pyramid.scale_factor;
  for (const PlaceMatch& m : matches)
    equations.push_back({a.landmarks[m.a].position, b.landmarks[m.b].position,
                         a.views[m.in_a.view].keyframe->cam_from_submap, b.views[m.in_b.view].keyframe->cam_from_submap,
                         a.pixel(m.in_a), b.pixel(m.in_b), std::pow(factor_a, a.octave(m.in_a)),
                         std::pow(factor_b, b.octave(m.in_b))});
  return equations;
}

double reprojection_error_px(const PlaceEquation& e, const Camera& camera_a, const Camera& camera_b,
                             const Sim3& b_from_a, const Sim3& a_from_b) {
  const Eigen::Vector3d in_b = e.cam_from_b * (b_from_a * e.point_a);
  const Eigen::Vector3d in_a = e.cam_from_a * (a_from_b * e.point_b);
  if (!(in_a.z() > 1e-9 && in_b.z() > 1e-9)) return std::numeric_limits<double>::infinity();
  return std::max((camera_b.project_undistorted(in_b) - e.pixel_b).norm() / e.sigma_b_px,
                  (camera_a.project_undistorted(in_a) - e.pixel_a).norm() / e.sigma_a_px);
}

std::optional<Consensus> find_consensus(const std::vector<PlaceEquation>& equations, const std::vector<int>& among,
                                        const Camera& camera_a, const Camera& camera_b, double max_error_px,
                                        int iterations) {
  return Ransac(equations, among, camera_a, camera_b, max_error_px).run(iterations);
}

}  // namespace rumi::map_server
