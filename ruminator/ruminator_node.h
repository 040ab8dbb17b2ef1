// SPDX-License-Identifier: BSD-3-Clause
// ruminator, first version: follows the tracking state, keeps the images around every loss and announces the windows.
// Complete windows wait here, in state QUEUED with their images; rebuilding them is not part of this version.
#pragma once

#include <deque>
#include <set>
#include <string>
#include <unordered_set>

#include "bus/bus.h"
#include "bus/process.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"
#include "ruminator/frame_ring.h"
#include "ruminator/image_motion.h"
#include "ruminator/options.h"
#include "ruminator/window_sampler.h"

namespace rumi {

class RuminatorNode : public Node {
 public:
  RuminatorNode(Bus& bus, const RuminatorOptions& options);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  void finish() override;

  const std::deque<RuminationWindow>& queued() const { return queued_; }
  const FrameRing& frames() const { return ring_; }
  int64_t dropped_windows() const { return dropped_windows_; }

 private:
  struct PendingTrack {
    track_t track;
    int64_t arrived_us = 0;
  };
  void on_image(const image_t& image);
  void on_track(const track_t& track);
  void process_pending(int64_t now_us, bool all);
  void process(const track_t& track);
  FrameEvent event(const track_t& track) const;
  void settle(int64_t utime_us);
  bool is_needed(int64_t utime_us) const;
  void note_queued_utimes();
  void make_room(const image_t& image);
  void drop_oldest_window();
  void enqueue(RuminationWindow window);
  void announce(const RuminationWindow& window, int8_t state);

  Bus& bus_;
  RuminatorOptions options_;
  WindowSampler sampler_;
  FrameRing ring_;
  ImageMotion motion_;
  std::deque<PendingTrack> pending_;  // in order of arrival
  std::deque<RuminationWindow> queued_;
  std::unordered_set<int64_t> queued_utimes_;  // samples of all queued windows
  std::set<int64_t> retained_;                 // sampler_.retained() after the last frame
  int64_t last_announced_us_ = 0;
  int64_t last_utime_us_ = 0;
  int64_t without_image_ = 0;
  int64_t dropped_windows_ = 0;
  int64_t rejected_ = 0;
};

// As announced on RUMI_WINDOW; utime is the announcement's.
window_t to_message(const RuminationWindow& window, int64_t utime_us, int8_t state);

}  // namespace rumi
