// SPDX-License-Identifier: BSD-3-Clause
// Furniture of a room. Each piece is built in a local frame: origin on the floor in the middle of its back, x along its
// width, y from back to front, z up. Sizes are in metres.
#pragma once

#include "synth/mesh.h"

namespace rumi::synth {

void add_bookcase(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
// A table and a cabinet have clutter on top, which is at most `clutter_height` high.
void add_table(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height,
               double clutter_height);
void add_cabinet(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height,
                 double clutter_height);
void add_box_stack(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
void add_chair(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
void add_plant(MeshBuilder& b, const SE3& room_from_local, double width, double height);
void add_floor_lamp(MeshBuilder& b, const SE3& room_from_local, double width, double height);
void add_door(MeshBuilder& b, const SE3& room_from_local, double width, double depth, double height);
void add_pillar(MeshBuilder& b, const SE3& room_from_local, double width, double height);

}  // namespace rumi::synth
