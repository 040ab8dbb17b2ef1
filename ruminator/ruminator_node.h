// SPDX-License-Identifier: BSD-3-Clause
// Follows the tracking state, keeps the images around each loss, has the windows rebuilt, and sends the back submaps to
// map_server.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"
#include "ruminator/colmap_builder.h"
#include "ruminator/options.h"
#include "ruminator/queue/rebuild_queue.h"
#include "ruminator/window/frame_ring.h"
#include "ruminator/window/image_motion.h"
#include "ruminator/window/learned_masks.h"
#include "ruminator/window/window_sampler.h"

namespace rumi::ruminator {

struct RuminatorHooks {
  Builder builder;                               // required if options.rebuild is set
  std::function<std::string()> builder_problem;  // returns the builder's fault (of COLMAP), for users; may be null
  std::function<void(const WindowJob&)> on_job;  // called with each complete window; may be null
  RebuildQueue::BuiltHandler on_built;

  void use(const ColmapBuilder& colmap) {
    builder = colmap.builder;
    builder_problem = colmap.problem;
  }
};

class RuminatorNode : public Node {
 public:
  // If `camera` is not given, uses the calibration that comes with the images.
  RuminatorNode(Bus& bus, const RuminatorOptions& options, RuminatorHooks hooks,
                const std::optional<Camera>& camera = std::nullopt);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  void finish() override;
  void stop() override;
  std::string waits_for() const override { return queue_.waits_for(); }

  // Rebuilds images that were looked at before, in another company (ruminator/again): `gap` are the samples, and
  // `images` theirs, both in order of time, of the last session. After finish(); waits_for() tells when it is done.
  void rebuild_again(std::vector<Sample> gap, std::vector<image_t> images);

  int64_t session() const { return session_; }  // of the last state
  int64_t stream() const { return stream_; }
  const FrameRing& frames() const { return ring_; }
  const RebuildQueue& queue() const { return queue_; }

 private:
  struct PendingTrack {
    track_t track;
    int64_t arrived_us = 0;
  };
  void on_image(const image_t& image);
  void on_track(const track_t& track);
  void on_mask(const mask_t& mask);
  void process_pending(int64_t now_us, bool all);
  void process(const track_t& track);
  FrameEvent event(const track_t& track) const;
  bool is_needed(const ImageId& image) const;
  void settle(int64_t utime_us);
  void make_room(const image_t& image);
  void end_window();
  std::vector<image_t> images_of(const RuminationWindow& window) const;
  void hand_on(const RuminationWindow& window, std::vector<image_t> images);
  Result<WindowJob> make_job(const RuminationWindow& window, std::vector<image_t> images) const;
  void announce(const RuminationWindow& window, int8_t state);

  Bus& bus_;
  NewestSender sessions_{"RUMI_TRACK"};
  RuminatorOptions options_;
  RuminatorHooks hooks_;
  std::optional<Camera> given_camera_;
  WindowSampler sampler_;
  FrameRing ring_;
  ImageMotion motion_;
  LearnedMasks masks_;
  std::deque<PendingTrack> pending_;  // states that wait for their images, in order of arrival
  std::set<int64_t> retained_;        // sampler_.retained() after the last frame
  int64_t last_announced_us_ = 0;
  int64_t last_utime_us_ = 0;
  int64_t without_image_ = 0;
  int64_t rejected_ = 0;
  int64_t session_ = 0, stream_ = 0;  // of the last tracking state
  RebuildQueue queue_;
};

}  // namespace rumi::ruminator
