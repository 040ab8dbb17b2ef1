// SPDX-License-Identifier: BSD-3-Clause
// Things that stand in a room. Each is built in a local frame: origin on the floor in the middle of its back, x along
// its width, y from the back to the front, z up. Sizes in metres.
#pragma once

#include "synth/mesh.h"

namespace rumi::synth {

void add_bookcase(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
// Legs, a top, and clutter on it that is at most `clutter_height` high.
void add_table(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height,
               double clutter_height);
void add_cabinet(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height,
                 double clutter_height);
void add_box_stack(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
void add_chair(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
void add_plant(MeshBuilder& b, const SE3& room_from_local, double width, double height);
void add_floor_lamp(MeshBuilder& b, const SE3& room_from_local, double width, double height);
void add_pillar(MeshBuilder& b, const SE3& room_from_local, double width, double height);

}  // namespace rumi::synth
