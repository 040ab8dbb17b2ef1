// SPDX-License-Identifier: BSD-3-Clause
// Does a model hang together? Where a camera turns on the spot, two groups of images can each be right and be put
// anywhere to each other: what the one sees and the other too is taken for outliers, and no error shows it. But the
// verified matches between the two groups then belong to a point on one side only.
#pragma once

#include <set>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"

namespace rumi::ruminator {

// Part of two images' matches that a model may contradict; more is torn. The second where else nothing is left that
// joins the window to the front.
constexpr double kMaxSevered = 0.15;
constexpr double kMaxSeveredAdrift = 0.25;

// A pair of images that both have a pose.
struct PairAgreement {
  int first = 0, second = 0;  // images
  int shared = 0;             // matches that are observations of one point
  int severed = 0;            // of which one keypoint alone belongs to a point, or each to another
};

// Of all pairs of the model's images, in their order.
std::vector<PairAgreement> pair_agreements(const std::vector<ImagePair>& pairs, const SparseModel& model);

// Images that are torn off from the largest part of the model. Parts are images that hang together over sound
// agreements, the strongest first, unless what they have in common is torn as a whole: so a few matches around a loop
// do not hold what is torn at its neighbours, and a tear that few matches of any one pair cross shows in all of them
// together. Empty for a sound model.
std::set<int> torn_off(const std::vector<PairAgreement>& agreements, double max_severed, const SparseModel& model);

}  // namespace rumi::ruminator
