// SPDX-License-Identifier: BSD-3-Clause
// Sun and sky of a day, and the shadows that houses and trees throw.
#pragma once

#include <opencv2/core/mat.hpp>

#include "synth/street_plan.h"

namespace rumi::synth {

struct StreetDay {
  Eigen::Vector3d to_sun;  // unit vector
  double sky, sun;         // brightness of a surface in the light of the sky, and of the sun that shines straight on it
  double clouds;           // share of the sky
};
StreetDay make_day(uint64_t seed, int day);

class StreetLight {
 public:
  StreetLight(const StreetDay& day, const StreetField& field, const StreetPlan& plan);

  // Returns the light of the sky on a surface, and that of the sun where nothing is in its way.
  double sky(const Eigen::Vector3d& normal) const;
  double sun(const Eigen::Vector3d& normal) const;
  // Returns whether the sun reaches a point.
  bool sees_sun(const Eigen::Vector3d& at) const;
  // Share of the sun on the ground, CV_8U. Its pixels are map_cell_m() wide, from the field's low corner on.
  const cv::Mat& map() const { return map_; }
  double map_cell_m() const { return cell_m_; }

 private:
  void raise(const StreetPlan& plan, const StreetField& field);
  void draw_map(const StreetField& field);

  StreetDay day_;
  Eigen::Vector2d low_;
  double cell_m_ = 0.5;
  cv::Mat top_;  // CV_32F: height of what stands there, m; a low number if nothing does
  cv::Mat map_;
};

}  // namespace rumi::synth
