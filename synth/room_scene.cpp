// SPDX-License-Identifier: BSD-3-Clause
#include "synth/room_scene.h"

namespace rumi::synth {

RoomScene::RoomScene(const SynthOptions& options, const Walk& walk, const Camera& pinhole)
    : shape_(walk.repeats ? fit_cell(walk.path, *walk.repeats, walk.doorway)
                          : fit_room(walk.path, options.seed, walk.doorway)) {
  Mesh mesh = build_room(shape_, options.seed, options.camera.fx);
  bake_light(mesh, shape_);
  if (walk.repeats) mesh = repeat(mesh, walk.repeats->copies, options.alike, options.seed);
  rasterizer_ = std::make_unique<Rasterizer>(std::move(mesh), pinhole);
}

void RoomScene::draw(const Moment& moment, cv::Mat* rgba) {
  rasterizer_->draw(moment.map_from_cam.inverse() * shape_.room_from_map.inverse(), moment.blankness, rgba);
}

}  // namespace rumi::synth
