// SPDX-License-Identifier: BSD-3-Clause
// A town around a path, or a campus.
#pragma once

#include <memory>

#include "slam/geometry/camera.h"
#include "synth/camera_path.h"
#include "synth/options.h"
#include "synth/scene.h"

namespace rumi::synth {

class StreetScene : public Scene {
 public:
  // Builds the street along the whole path, which takes seconds. Throws std::runtime_error if the path does not do.
  StreetScene(const SynthOptions& options, const CameraPath& path, const Camera& pinhole);
  ~StreetScene() override;

  // Returns the path with its heights and, for a robot, its shaking: the camera is as high above the road as the
  // vehicle carries it.
  const CameraPath& camera_path() const;
  SE3 shaken(const SE3& map_from_cam, double time_s) const;

  void draw(const Moment& moment, cv::Mat* rgba) override;
  double gain(double time_s) override;
  double typical_depth_m() const override { return 12; }
  double blur_step_px() const override { return 4; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rumi::synth
