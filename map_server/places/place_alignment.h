// SPDX-License-Identifier: BSD-3-Clause
// Decides whether two keyframes look at the same place, and computes how one submap lies in the other. It serves
// submaps that share no images, and loops of one submap (Chen et al., "Rumination Meets VSLAM", section IV.C).
// Landmarks are matched by descriptor. Three pairs propose a similarity (Umeyama in RANSAC). All landmarks of both
// places are searched again where the similarity puts them. It is refined by reprojection in both directions
// (slam/optimization/sim3_refinement.h).
//
// A wrong join ruins a map, and a missed join can be made later. So an alignment in doubt is refused.
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
  int neighbours = 4;  // views of either place besides the keyframe itself
  int witnesses = 6;   // of either place; the alignment does not use them

  int min_proposed = 15;              // landmark pairs by descriptor
  int ransac_iterations = 1000;       // at most
  double consensus_px = 6.0;          // in both directions, at octave 0; landmarks themselves are off by some pixels
  int min_consensus = 10;             // of the proposed pairs (those of the two keyframes alone, too), and ...
  double min_consensus_ratio = 0.25;  // ... of them
  double max_rival_ratio = 0.5;       // what another similarity explains of the rest, over the consensus

  double guided_radius_px = 8.0;  // at octave 0
  double inlier_px = 4.0;         // in both directions, at octave 0
  int min_inliers = 40;
  double min_inlier_ratio = 0.5;   // of the guided matches
  double min_found_ratio = 0.1;    // inliers over the landmarks of a that should be in view of keyframe b
  int min_cells = 12;              // of 8 x 6 over the image, with an inlier, in keyframe a and in keyframe b
  double min_extent_ratio = 0.12;  // second largest standard deviation of the inliers' positions over their depth
  double max_sigma_rotation_deg = 1.0;
  double max_sigma_log_scale = 0.05;
  double max_sigma_translation = 0.05;  // over the median depth of the inliers

  double witness_radius_px = 5.0;  // at octave 0
  int min_witness_found = 20;      // landmarks of the other place that a witness sees
  double min_witness_ratio = 0.2;  // of those that should be in view of it
  int min_witnesses = 2;           // of each place that must confirm the alignment
};

struct PlaceAlignment {
  Sim3 b_from_a;
  std::vector<LandmarkPair> landmarks;  // the inliers: the same point in both
  int proposed = 0;                     // pairs by descriptor alone
  int consensus = 0, rival = 0;         // of those: with the best similarity, with the best of the rest
  int guided = 0;                       // pairs found where b_from_a puts them
  int inliers = 0;                      // of those
  int visible = 0;                      // landmarks of a that should be in view of keyframe b
  int cells = 0;                        // of 8 x 6 with an inlier, the fewer of the two keyframes
  double rmse_px = 0;                   // of the inliers, both directions, in units of their octave
  double extent_ratio = 0;
  double median_depth = 0;  // of the inliers, from keyframe b, in the unit of b
  double sigma_rotation_deg = 0, sigma_log_scale = 0;
  double sigma_translation = 0;          // over the median depth
  int witnesses_a = 0, witnesses_b = 0;  // keyframes that the alignment does not use and that confirm it
  std::vector<Witness> heard;            // those of a, then those of b
  std::string doubt;                     // why the alignment is refused, with the numbers; empty if it is accepted
};

// `a` and `b` may be one submap: a loop. Lengths of sigma and extent are relative, so that the unit does not matter.
// Deterministic. It takes some 15 ms for 1000 keypoints a keyframe, at most 50, and a third of that if the places have
// nothing in common.
//
// If two places look alike in all keyframes here, they cannot be told apart. So before the caller joins submaps, it
// should have several alignments of different keyframes that agree.
PlaceAlignment align_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b,
                            const PlaceAlignmentOptions& options = {});

}  // namespace rumi::map_server
