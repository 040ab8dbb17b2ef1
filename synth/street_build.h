// SPDX-License-Identifier: BSD-3-Clause
// Builds what stands still in a street.
#pragma once

#include "synth/street_models.h"
#include "synth/street_style.h"

namespace rumi::synth {

struct StreetSite {
  const StreetField& field;
  const StreetStyle& style;
  const StreetPlan& plan;
  const StreetLight& light;
  const StreetModels& models;
  uint64_t seed;
  int day;

  // Returns a point on the road or, beyond the kerb, on the pavement.
  Eigen::Vector3d on_ground(const Eigen::Vector2d& at) const {
    const bool high = field.distance_m(at) > style.kerb_m;
    return {at.x(), at.y(), field.ground_m(at) + (high ? style.kerb_height_m : 0)};
  }
};

void build_ground(const StreetSite& site, StreetMeshBuilder* mesh);
void build_marks(const StreetSite& site, StreetMeshBuilder* mesh);
void build_houses(const StreetSite& site, TextureAtlas* atlas, StreetMeshBuilder* mesh);
void build_things(const StreetSite& site, StreetMeshBuilder* mesh);

}  // namespace rumi::synth
