// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "front_tracker/frame/tracking_options.h"
#include "front_tracker/initialization/initializer_options.h"
#include "front_tracker/mapping/mapping_options.h"
#include "front_tracker/tracking/keyframe_options.h"
#include "slam/features/orb_extractor.h"

namespace rumi::front_tracker {

struct TrackerOptions {
  OrbOptions orb;
  InitializerOptions initializer;
  TrackingOptions tracking;
  KeyframeOptions keyframes;
  MappingOptions mapping;
  bool mapping_thread = true;  // false: mapping ends before the next frame, so that a replay is repeatable
};

}  // namespace rumi::front_tracker
