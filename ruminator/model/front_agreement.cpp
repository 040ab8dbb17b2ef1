// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/front_agreement.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/alignment.h"
#include "slam/numeric/median.h"

namespace rumi::ruminator {
namespace {

struct PosePair {
  SE3 cam_from_front, cam_from_model;
};

// Every frame gives a rotation from model to front submap. Returns the median difference of the others from the one
// that agrees best.
double rotation_difference_deg(const std::vector<PosePair>& pairs) {
  std::vector<Eigen::Quaterniond> front_from_model;
  front_from_model.reserve(pairs.size());
  for (const PosePair& p : pairs)
    front_from_model.push_back(p.cam_from_front.rotation.conjugate() * p.cam_from_model.rotation);
  double best = M_PI;
  for (const Eigen::Quaterniond& candidate : front_from_model) {
    std::vector<double> angles;
    angles.reserve(front_from_model.size());
    for (const Eigen::Quaterniond& other : front_from_model) angles.push_back(candidate.angularDistance(other));
    best = std::min(best, median(&angles));
  }
  return best * 180 / M_PI;
}

double position_difference(const std::vector<PosePair>& pairs) {
  std::vector<Eigen::Vector3d> front, model;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PosePair& p : pairs) {
    front.push_back(p.cam_from_front.center());
    model.push_back(p.cam_from_model.center());
    mean += front.back() / static_cast<double>(pairs.size());
  }
  const auto front_from_model = umeyama(model, front);
  double error = 0, spread = 0;
  for (size_t i = 0; i < front.size(); ++i) {
    if (front_from_model) error += (*front_from_model * model[i] - front[i]).squaredNorm();
    spread += (front[i] - mean).squaredNorm();
  }
  return front_from_model && spread > 0 ? std::sqrt(error / spread) : 1;
}

}  // namespace

std::vector<FrontAgreement> compare_with_front(const std::vector<Sample>& samples,
                                               const std::map<int64_t, SE3>& cam_from_model) {
  std::map<int32_t, std::vector<PosePair>> by_submap;
  for (const Sample& sample : samples) {
    const auto pose = cam_from_model.find(sample.utime_us);
    if (sample.submap_id != kNoSubmap && pose != cam_from_model.end())
      by_submap[sample.submap_id].push_back({sample.cam_from_submap, pose->second});
  }
  std::vector<FrontAgreement> agreements;
  for (const auto& [id, pairs] : by_submap)
    if (pairs.size() >= kMinFrontFrames)
      agreements.push_back(
          {id, static_cast<int>(pairs.size()), rotation_difference_deg(pairs), position_difference(pairs)});
  return agreements;
}

}  // namespace rumi::ruminator
