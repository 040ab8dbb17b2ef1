// SPDX-License-Identifier: BSD-3-Clause
// Cars and people that move. Where they are depends on the time alone, so that images may be drawn in any order.
#pragma once

#include "synth/street_build.h"
#include "synth/street_route.h"

namespace rumi::synth {

class StreetTraffic {
 public:
  // `share`: 1 is normal, 0 none. Times count from `begin_s`, when the path begins.
  StreetTraffic(const StreetSite& site, const Route& route, double share, double begin_s)
      : s_(site), route_(route), share_(share), begin_s_(begin_s) {}

  // Appends what moves near the camera at that time.
  void add(double time_s, const Eigen::Vector2d& camera, Triangles* out) const;
  // Appends a lorry that overtakes from the left, drives close ahead, so that it covers most of the image, and leaves.
  // phase: 0..1. `half_view` is half the image's width divided by the focal length.
  void add_lorry(double phase, const SE3& street_from_cam, double half_view, Triangles* out) const;

 private:
  void add_car(double way_m, double left_m, bool backwards, cv::RNG rng, Triangles* out) const;
  void add_encounters(double time_s, Triangles* out) const;
  void add_leading_car(double time_s, Triangles* out) const;
  void add_people(double time_s, const Eigen::Vector2d& camera, Triangles* out) const;
  cv::RNG chance(uint64_t kind, uint64_t number) const;

  const StreetSite& s_;
  const Route& route_;
  double share_, begin_s_;
};

}  // namespace rumi::synth
