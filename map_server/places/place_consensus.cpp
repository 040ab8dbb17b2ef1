// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_consensus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slam/geometry/alignment.h"

namespace rumi::map_server {
namespace {

constexpr double kMissProbability = 1e-4;

class PlaceModel {
 public:
  PlaceModel(const std::vector<PlaceEquation>& equations, const std::vector<int>& among, const Camera& camera_a,
             const Camera& camera_b, double max_error_px)
      : equations_(equations), among_(among), camera_a_(camera_a), camera_b_(camera_b), max_error_px_(max_error_px) {}

  // Returns the similarity fitted to three pairs if all three agree with it; they rarely do if one of them is wrong.
  std::optional<Sim3> propose(const std::array<int, 3>& sample) const {
    const auto b_from_a = fit(sample);
    if (!b_from_a) return std::nullopt;
    const Sim3 a_from_b = b_from_a->inverse();
    const bool all_agree =
        std::all_of(sample.begin(), sample.end(), [&](int i) { return agrees(among_[i], *b_from_a, a_from_b); });
    return all_agree ? b_from_a : std::nullopt;
  }

  std::vector<int> agreeing(const Sim3& b_from_a) const {
    const Sim3 a_from_b = b_from_a.inverse();
    std::vector<int> members;
    for (int i = 0; i < static_cast<int>(among_.size()); ++i)
      if (agrees(among_[i], b_from_a, a_from_b)) members.push_back(i);
    return members;
  }

 private:
  std::optional<Sim3> fit(const std::array<int, 3>& sample) const {
    std::vector<Eigen::Vector3d> from, to;
    for (const int i : sample) {
      from.push_back(equations_[among_[i]].point_a);
      to.push_back(equations_[among_[i]].point_b);
    }
    auto b_from_a = umeyama(from, to);
    if (b_from_a && !(b_from_a->is_finite() && b_from_a->inverse().is_finite())) b_from_a.reset();
    return b_from_a;
  }

  bool agrees(int equation, const Sim3& b_from_a, const Sim3& a_from_b) const {
    return reprojection_error_px(equations_[equation], camera_a_, camera_b_, b_from_a, a_from_b) <= max_error_px_;
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

std::optional<Consensus<Sim3>> find_consensus(const std::vector<PlaceEquation>& equations,
                                              const std::vector<int>& among, const Camera& camera_a,
                                              const Camera& camera_b, double max_error_px, int samples) {
  const PlaceModel model(equations, among, camera_a, camera_b, max_error_px);
  std::optional<Consensus<Sim3>> found = find_consensus_of_three(
      among.size(), {.samples = samples, .miss_probability = kMissProbability, .seed = 4711},
      [&](const std::array<int, 3>& sample) { return model.propose(sample); },
      [&](const Sim3& b_from_a) { return model.agreeing(b_from_a); });
  if (found)
    for (int& member : found->members) member = among[member];
  return found;
}

}  // namespace rumi::map_server
