// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_alignment.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "map_server/places/place_consensus.h"
#include "slam/numeric/median.h"
#include "slam/optimization/sim3_refinement.h"

namespace rumi::map_server {
namespace {

constexpr int kCellColumns = 8, kCellRows = 6;

class PlaceAligner {
 public:
  PlaceAligner(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const PlaceAlignmentOptions& options)
      : a_(a), b_(b), camera_a_(a.submap->camera), camera_b_(b.submap->camera), o_(options) {}

  PlaceAlignment run() {
    if (!propose() || !search_and_refine()) return result_;
    measure();
    hear_witnesses();
    result_.doubt = judge();
    return result_;
  }

 private:
  bool refuse(std::string doubt) {
    result_.doubt = std::move(doubt);
    return false;
  }

  // Proposes a similarity. First compares each place's own keyframe with the views of the other place: that refuses
  // most pairs of unrelated places at a third of the work.
  bool propose() {
    PlaceProposals proposals(a_, b_, o_.matching);
    for (size_t i = 0; i < a_.views.size(); ++i)
      for (size_t j = 0; j < b_.views.size(); ++j)
        if (i == 0 || j == 0) proposals.compare(i, j);
    if (!agree(proposals.ranked(), o_.min_consensus, 0)) return false;
    for (size_t i = 1; i < a_.views.size(); ++i)
      for (size_t j = 1; j < b_.views.size(); ++j) proposals.compare(i, j);
    const auto best = agree(proposals.ranked(), o_.min_consensus, o_.min_consensus_ratio);
    if (!best) return false;
    inliers_ = best->members;
    result_.b_from_a = best->model;

    const std::vector<int> among = all();
    std::vector<int> rest;
    std::set_difference(among.begin(), among.end(), inliers_.begin(), inliers_.end(), std::back_inserter(rest));
    if (const auto rival = consensus(rest)) result_.rival = static_cast<int>(rival->members.size());
    if (result_.rival > o_.max_rival_ratio * result_.consensus)
      return refuse(fmt::format("another similarity explains {} landmarks, this one {}: something repeats",
                                result_.rival, result_.consensus));
    return true;
  }

  // Returns the similarity that most matches agree with; nullopt, with a doubt, if too few agree.
  std::optional<Consensus<Sim3>> agree(const std::vector<PlaceMatch>& matches, int least, double least_ratio) {
    result_.proposed = static_cast<int>(matches.size());
    if (result_.proposed < o_.min_proposed) {
      refuse(fmt::format("{} landmarks look alike, {} wanted", result_.proposed, o_.min_proposed));
      return std::nullopt;
    }
    equations_ = make_equations(a_, b_, matches);
    auto best = consensus(all());
    result_.consensus = best ? static_cast<int>(best->members.size()) : 0;
    const double wanted = std::max<double>(least, least_ratio * result_.proposed);
    if (best && result_.consensus >= wanted) return best;
    refuse(fmt::format("{} of {} landmarks that look alike agree on a similarity, {:.0f} wanted", result_.consensus,
                       result_.proposed, std::ceil(wanted)));
    return std::nullopt;
  }

  std::vector<int> all() const {  // indices of all equations
    std::vector<int> indices(equations_.size());
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
  }

  std::optional<Consensus<Sim3>> consensus(const std::vector<int>& among) const {
    return find_consensus(equations_, among, camera_a_, camera_b_, o_.consensus_px, o_.ransac_iterations);
  }

  // Alternates twice: the refined similarity finds more and better pairs, and they refine it again. Returns false, with
  // a doubt, if too few landmarks agree.
  bool search_and_refine() {
    if (!refine()) return false;
    for (const double radius : {2 * o_.guided_radius_px, o_.guided_radius_px}) {
      matches_ = guided_matches(a_, b_, result_.b_from_a, radius, o_.matching);
      result_.guided = static_cast<int>(matches_.size());
      equations_ = make_equations(a_, b_, matches_);
      inliers_ = all();
      if (!refine()) return false;
    }
    inliers_.clear();
    const Sim3 a_from_b = result_.b_from_a.inverse();
    double sum = 0;
    for (size_t i = 0; i < equations_.size(); ++i) {
      const double error = reprojection_error_px(equations_[i], camera_a_, camera_b_, result_.b_from_a, a_from_b);
      if (error > o_.inlier_px) continue;
      sum += error * error;
      inliers_.push_back(static_cast<int>(i));
      result_.landmarks.push_back({a_.landmarks[matches_[i].a].id, b_.landmarks[matches_[i].b].id});
    }
    std::sort(result_.landmarks.begin(), result_.landmarks.end(),
              [](const LandmarkPair& x, const LandmarkPair& y) { return x.a < y.a; });
    result_.inliers = static_cast<int>(inliers_.size());
    result_.rmse_px = std::sqrt(sum / std::max(1, result_.inliers));
    if (result_.inliers < std::max(3, o_.min_inliers))
      return refuse(fmt::format("{} landmarks agree, {} wanted", result_.inliers, o_.min_inliers));
    return true;
  }

  // Converts a pixel of camera a to the one of camera b with the same ray: the refinement knows only camera b.
  Eigen::Vector2d pixel_in_b(const Eigen::Vector2d& pixel_a) const {
    return {(pixel_a.x() - camera_a_.cx) * camera_b_.fx / camera_a_.fx + camera_b_.cx,
            (pixel_a.y() - camera_a_.cy) * camera_b_.fy / camera_a_.fy + camera_b_.cy};
  }

  bool refine() {
    Sim3RefinementProblem problem;
    for (int i : inliers_) {
      const PlaceEquation& e = equations_[i];
      problem.a_into_b.push_back({e.point_a, e.cam_from_b, e.pixel_b, e.sigma_b_px});
      problem.b_into_a.push_back(
          {e.point_b, e.cam_from_a, pixel_in_b(e.pixel_a), e.sigma_a_px * camera_b_.fx / camera_a_.fx});
    }
    Sim3RefinementOptions options;
    options.inlier_chi2 = o_.inlier_px * o_.inlier_px;
    const Sim3RefinementReport report = refine_sim3(camera_b_, options, problem, &result_.b_from_a);
    if (!report.usable)
      return refuse(fmt::format("{} landmarks do not determine it: {}", inliers_.size(), report.reason));
    result_.sigma_rotation_deg = report.sigma_rotation_rad * 180 / M_PI;
    result_.sigma_log_scale = report.sigma_log_scale;
    sigma_translation_ = report.sigma_translation;
    return true;
  }

  void measure() {
    std::vector<double> depths;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::set<int> cells_a, cells_b;
    const Sim3 a_from_b = result_.b_from_a.inverse();
    const SE3 &cam_from_a = a_.views[0].keyframe->cam_from_submap, &cam_from_b = b_.views[0].keyframe->cam_from_submap;
    for (int i : inliers_) {
      const PlaceEquation& e = equations_[i];
      depths.push_back((cam_from_b * e.point_b).norm());
      mean += e.point_b / static_cast<double>(inliers_.size());
      mark_cell(camera_a_, cam_from_a * (a_from_b * e.point_b), &cells_a);
      mark_cell(camera_b_, cam_from_b * (result_.b_from_a * e.point_a), &cells_b);
    }
    result_.cells = static_cast<int>(std::min(cells_a.size(), cells_b.size()));
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (int i : inliers_) {
      const Eigen::Vector3d d = equations_[i].point_b - mean;
      scatter += d * d.transpose() / static_cast<double>(inliers_.size());
    }
    const double depth = result_.median_depth = median(&depths);
    const Eigen::Vector3d variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
    result_.extent_ratio = std::sqrt(std::max(0.0, variances[1])) / depth;
    result_.sigma_translation = sigma_translation_ / depth;
  }

  static void mark_cell(const Camera& camera, const Eigen::Vector3d& in_cam, std::set<int>* cells) {
    if (!(in_cam.z() > 1e-9)) return;
    const Eigen::Vector2d pixel = camera.project_undistorted(in_cam);
    if (!camera.contains(pixel)) return;
    cells->insert(static_cast<int>(pixel.y() * kCellRows / camera.height) * kCellColumns +
                  static_cast<int>(pixel.x() * kCellColumns / camera.width));
  }

  void hear_witnesses() {
    const auto hear = [&](const PlaceNeighbourhood& from, const PlaceNeighbourhood& to, const Sim3& to_from_from) {
      int bear_out = 0;
      for (const PlaceView& witness : to.witnesses) {
        const Witness w = hear_witness(from, *to.submap, witness, to_from_from, o_.witness_radius_px, o_.matching);
        result_.heard.push_back(w);
        if (w.found < o_.min_witness_found || w.found < o_.min_witness_ratio * w.visible) continue;
        ++bear_out;
        // A witness that sees little of the place is elsewhere, or behind something: it does not speak against it.
        result_.telling += w.telling;
        result_.silent += w.silent;
      }
      return bear_out;
    };
    result_.witnesses_a = hear(b_, a_, result_.b_from_a.inverse());
    result_.witnesses_b = hear(a_, b_, result_.b_from_a);
    result_.visible =
        hear_witness(a_, *b_.submap, b_.views[0], result_.b_from_a, o_.witness_radius_px, o_.matching).visible;
  }

  std::string judge() const {
    const PlaceAlignment& r = result_;
    if (r.inliers < o_.min_inlier_ratio * r.guided)
      return fmt::format("{} of {} matches found by projection agree", r.inliers, r.guided);
    if (r.inliers < o_.min_found_ratio * r.visible)
      return fmt::format("{} of {} landmarks that should be in view are", r.inliers, r.visible);
    if (r.cells < o_.min_cells)
      return fmt::format("what agrees covers {} of {} cells of an image, {} wanted", r.cells, kCellColumns * kCellRows,
                         o_.min_cells);
    if (r.extent_ratio < o_.min_extent_ratio)
      return fmt::format("what agrees extends over {:.3f} of its distance, {} wanted", r.extent_ratio,
                         o_.min_extent_ratio);
    if (!(r.sigma_rotation_deg <= o_.max_sigma_rotation_deg && r.sigma_log_scale <= o_.max_sigma_log_scale &&
          r.sigma_translation <= o_.max_sigma_translation))
      return fmt::format("known to {:.2f} deg, scale {:.3f}, translation {:.3f} of the depth only",
                         r.sigma_rotation_deg, r.sigma_log_scale, r.sigma_translation);
    if (std::min(r.witnesses_a, r.witnesses_b) < o_.min_witnesses)
      return fmt::format("{} of {} and {} of {} further keyframes of the two places bear it out, {} wanted",
                         r.witnesses_a, a_.witnesses.size(), r.witnesses_b, b_.witnesses.size(), o_.min_witnesses);
    if (r.silent > o_.max_silent_ratio * r.telling)
      return fmt::format("around {} of {} landmarks hardly any is seen where it should be: it only looks alike",
                         r.silent, r.telling);
    return {};
  }

  const PlaceNeighbourhood& a_;
  const PlaceNeighbourhood& b_;
  const Camera& camera_a_;
  const Camera& camera_b_;
  const PlaceAlignmentOptions& o_;
  std::vector<PlaceMatch> matches_;
  std::vector<PlaceEquation> equations_;
  std::vector<int> inliers_;  // indices into equations_
  double sigma_translation_ = 0;
  PlaceAlignment result_;
};

}  // namespace

PlaceAlignment align_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b,
                            const PlaceAlignmentOptions& options) {
  const PlacePair places = gather_places(a, keyframe_a, b, keyframe_b, options.neighbours, options.witnesses);
  PlaceAlignment refused;
  refused.doubt = places.doubt;
  if (!places.doubt.empty()) return refused;
  return PlaceAligner(places.a, places.b, options).run();
}

}  // namespace rumi::map_server
