// SPDX-License-Identifier: BSD-3-Clause
// Decides whether two keyframes look at the same place, and computes how one submap lies in the other. Used for submaps
// that share no images, and for loops within one submap (Chen et al., "Rumination Meets VSLAM", section IV.C).
// Landmarks are matched by descriptor; triples of pairs propose similarities (Umeyama in RANSAC). Then all landmarks of
// both places are searched for where the best similarity puts them, and it is refined by reprojection in both
// directions (slam/optimization/sim3_refinement.h).
//
// A wrong join ruins a map, while a missed join can be made later. Therefore an alignment in doubt is refused.
#pragma once

#include <string>
#include <vector>

#include "map_server/links/link_edge.h"
#include "map_server/places/place_matching.h"
#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct PlaceAlignmentOptions {
  PlaceMatchOptions matching;
  int neighbours = 4;  // most views of each place besides the keyframe itself
  int witnesses = 6;   // most witnesses of each place; the alignment does not use them

  int min_proposed = 15;         // least number of landmark pairs by descriptor
  int ransac_iterations = 1000;  // most iterations of RANSAC
  double consensus_px = 6.0;     // largest error, in both directions, at octave 0; large, as landmarks are inaccurate
  int min_consensus = 10;        // least number of agreeing pairs, also in the first comparison
  double min_consensus_ratio = 0.25;  // least share of the proposed pairs that agree
  double max_rival_ratio = 0.5;  // largest size of a second similarity's consensus, over the size of the best one's

  double guided_radius_px = 8.0;  // search radius at octave 0
  double inlier_px = 4.0;         // largest error of an inlier, in both directions, at octave 0
  int min_inliers = 40;
  double min_inlier_ratio = 0.5;  // least share of inliers among the guided matches
  double min_found_ratio = 0.1;   // least inliers over the landmarks of a that should be in view of keyframe b
  int min_cells = 12;  // least number of the image's 8 x 6 cells that have an inlier, in each of the two keyframes
  double min_extent_ratio = 0.12;  // least value of PlaceAlignment::extent_ratio
  double max_sigma_rotation_deg = 1.0;
  double max_sigma_log_scale = 0.05;
  double max_sigma_translation = 0.05;  // as a share of the median depth of the inliers

  double witness_radius_px = 5.0;  // search radius at octave 0
  int min_witness_found = 20;      // least number of the other place's landmarks that a witness sees
  double min_witness_ratio = 0.2;  // least share of those that should be in view of the witness
  int min_witnesses = 2;           // least number of witnesses of each place that confirm the alignment
  // Largest share of silent landmarks (see Witness) of these witnesses: where buildings repeat, much agrees, but
  // things are missing.
  double max_silent_ratio = 0.35;
};

struct PlaceAlignment {
  Sim3 b_from_a;
  std::vector<LandmarkPair> landmarks;  // the inliers: pairs of landmarks that are the same point
  int proposed = 0;                     // pairs by descriptor alone
  int consensus = 0, rival = 0;         // proposed pairs that agree with the best similarity, and with another one
  int guided = 0;                       // pairs found where b_from_a projects them
  int inliers = 0;                      // guided pairs that agree
  int visible = 0;                      // landmarks of a that should be in view of keyframe b
  int cells = 0;                        // cells (of 8 x 6) that have an inlier, in the keyframe that has fewer
  double rmse_px = 0;                   // root mean square error of the inliers, in both directions, px at octave 0
  double extent_ratio = 0;  // second-largest standard deviation of the inliers' positions, over the median depth
  double median_depth = 0;  // median depth of the inliers, from keyframe b, in b's unit
  double sigma_rotation_deg = 0, sigma_log_scale = 0;
  double sigma_translation = 0;          // standard deviation, as a share of the median depth
  int witnesses_a = 0, witnesses_b = 0;  // keyframes that the alignment does not use and that confirm it
  int telling = 0, silent = 0;           // sums of Witness::telling and silent of those that confirm it
  std::vector<Witness> heard;            // witnesses of a, then those of b
  std::string doubt;                     // why the alignment is refused, with the numbers; empty if it is accepted
};

// Aligns two places. `a` and `b` may be the same submap, for a loop. Translations and extents are relative to the
// depth, so that the unit does not matter. Deterministic. With 1000 keypoints a keyframe it takes some 15 ms, at most
// 50 ms, and a third of that if the places have nothing in common.
//
// Two places that look alike in all keyframes used here cannot be told apart. Before the caller joins submaps, it
// should therefore have several alignments of different keyframes that agree.
PlaceAlignment align_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b,
                            const PlaceAlignmentOptions& options = {});

}  // namespace rumi::map_server
