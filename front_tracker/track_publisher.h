// SPDX-License-Identifier: BSD-3-Clause
// Publishes RUMI_TRACK and CAMERA_TO_SUBMAP for each image, and again if the image gets or loses its pose afterwards.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "bus/transport/bus.h"
#include "front_tracker/tracking/track_result.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"

namespace rumi::front_tracker {

class TrackPublisher {
 public:
  explicit TrackPublisher(Bus& bus) : bus_(bus) {}

  // `stream` is that of the session's images.
  void begin_session(int64_t session, int64_t stream);
  // These two publish earlier frames again: those to which the present image gives a pose, and those that lose theirs.
  // To be called before publish(), so that receivers know which frames stay without a pose.
  void publish_posed_afterwards(const std::vector<TrackResult>& frames);
  void publish_withdrawn(const std::vector<int64_t>& utimes_us);
  void publish(const image_t& image, const TrackResult& result, double cpu_ms);

 private:
  using Told = std::map<int64_t, track_t>;  // by utime
  static void remember(const track_t& track, Told* told);

  Bus& bus_;
  int64_t session_ = 0, stream_ = 0;
  int64_t sequence_ = 0;
  Told without_pose_;  // messages about frames that may still get a pose
  Told with_pose_;     // messages about frames that may still lose theirs
};

}  // namespace rumi::front_tracker
