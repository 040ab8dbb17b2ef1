// SPDX-License-Identifier: BSD-3-Clause
// Tests whether a model is torn. If a camera rotates on the spot, two groups of images can each be right, but lie
// anywhere relative to each other. The points that both groups see are then treated as outliers, so that no error
// reveals it. But then many verified matches between the groups have a point on one side only.
#pragma once

#include <set>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"

namespace rumi::ruminator {

// The largest share of the matches between two parts that a model may contradict; above it the model is torn. The
// second limit is used if the first one leaves no image that connects the window to a front submap.
constexpr double kMaxSevered = 0.15;
constexpr double kMaxSeveredAdrift = 0.25;

// Whether the matches of two images agree with the model; both have a pose.
struct PairAgreement {
  int first = 0, second = 0;  // indices of the two images
  int shared = 0;             // matches that are observations of one point
  int severed = 0;            // matches with a point at only one keypoint, or different points at the two
};

// Returns the agreements of all pairs whose images both have a pose, in the order of the pairs.
std::vector<PairAgreement> pair_agreements(const std::vector<ImagePair>& pairs, const SparseModel& model);

// Returns the images of all parts, except the largest, that are torn from another part; empty for a sound model. Parts
// grow by joining images over sound pairs, the strongest first, but two parts are not joined if all matches between
// them together are torn. Therefore a few matches around a loop cannot hide a tear, and a tear with few matches in each
// pair shows in their sum.
std::set<int> torn_off(const std::vector<PairAgreement>& agreements, double max_severed, const SparseModel& model);

}  // namespace rumi::ruminator
