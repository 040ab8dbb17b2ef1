// SPDX-License-Identifier: BSD-3-Clause
// A furnished room as a scene.
#pragma once

#include "synth/next_room_walk.h"
#include "synth/rasterizer.h"
#include "synth/room.h"
#include "synth/scene.h"

namespace rumi::synth {

class RoomScene : public Scene {
 public:
  // The room holds the whole path even if only a part is asked for, so that all parts of a path have the same room.
  RoomScene(const SynthOptions& options, const Walk& walk, const Camera& pinhole);

  void draw(const Moment& moment, cv::Mat* rgba) override;
  double typical_depth_m() const override { return 2.5; }
  double blur_step_px() const override { return 2.5; }

 private:
  RoomShape shape_;
  std::unique_ptr<Rasterizer> rasterizer_;
};

}  // namespace rumi::synth
