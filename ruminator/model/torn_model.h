// SPDX-License-Identifier: BSD-3-Clause
// Is a model torn? Where a camera turns on the spot, two groups of images can each be right, but have any position
// relative to each other. What both groups see is then treated as outliers, and no error shows it. But the verified
// matches between the two groups then belong to a point on one side only.
#pragma once

#include <set>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"

namespace rumi::ruminator {

// The share of two images' matches that a model may contradict; beyond it the model is torn. The second limit is used
// if otherwise no image is left that joins the window to a front submap.
constexpr double kMaxSevered = 0.15;
constexpr double kMaxSeveredAdrift = 0.25;

// A pair of images that both have a pose.
struct PairAgreement {
  int first = 0, second = 0;  // images
  int shared = 0;             // matches that are observations of one point
  int severed = 0;            // matches with a point at one keypoint only, or another point at each
};

// Returns the agreement of all pairs of the model's images, in the order of the pairs.
std::vector<PairAgreement> pair_agreements(const std::vector<ImagePair>& pairs, const SparseModel& model);

// Images that are torn off from the largest part of the model; empty for a sound model. Parts grow by joining images
// over sound pairs, the strongest first. Two parts are not joined if what they have in common is torn as a whole. So a
// few matches around a loop cannot hold a tear together, and a tear that crosses few matches of each pair shows in
// their sum.
std::set<int> torn_off(const std::vector<PairAgreement>& agreements, double max_severed, const SparseModel& model);

}  // namespace rumi::ruminator
