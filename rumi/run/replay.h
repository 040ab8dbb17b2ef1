// SPDX-License-Identifier: BSD-3-Clause
// Runs all five components on one bus in one thread, in lockstep with the images: as fast as the machine can, and with
// the same result to the bit at any speed.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "bus/process/safe_node.h"
#include "bus/transport/log_file.h"
#include "bus/transport/memory_bus.h"
#include "map_server/map_server_node.h"
#include "map_server/outputs/trajectory_file.h"
#include "rumi/run/all_options.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::camera_driver {
class CameraNode;
class ImageSource;
struct SkippedFrames;
}  // namespace rumi::camera_driver

namespace rumi::front_tracker {
class FrontTrackerNode;
}

namespace rumi::ruminator {
class RuminatorNode;
}

namespace rumi::tool {

class MeteredBus;

struct ReplayProgress {
  int64_t frames = 0;                  // number of images published so far
  int64_t total = -1;                  // images in the input; -1: unknown
  int64_t utime_us = 0;                // time of the last published image
  std::function<std::string()> state;  // returns front_tracker's status
};

struct ReplayHooks {
  std::function<void(const ruminator::WindowJob&)> on_window;  // called for every complete window
  std::function<void(const ruminator::RuminationWindow&, const ruminator::BuildResult&)> on_rebuilt;
  const std::atomic<bool>* stop = nullptr;  // when it becomes true, windows are no longer rebuilt; may be null
};

class Replay {
 public:
  // Throws std::runtime_error, with a message for the user, for example on the input or the calibration. Options of a
  // live system are overridden: there are no threads, no spool, no database file (only the one to localize in is read),
  // and no pictures unless a series of them or a log is asked for.
  Replay(const AllOptions& options, const std::string& input, const ReplayHooks& hooks = {});
  ~Replay();

  // Writes all messages from now on into an lcm log, and adds the pictures of the viewer to them. The chunks of submaps
  // and maps are left out, as the outputs contain their content. Call it before the first step. An Error if the file
  // cannot be written.
  Result<> record(const std::string& log_file);
  // Ends the log. An Error, which names the file, if the log is not complete.
  Result<> close_log();

  // Publishes the next image, and lets every component do all that follows from it. Returns false at the end of the
  // input.
  bool step();
  // Ends all components in order, and returns when no work is left. Returns a note on the components that did not end
  // within a minute of logical time; empty if all did.
  std::string finish();

  ReplayProgress progress();
  const map_server::Atlas& atlas() const { return map_server_->atlas(); }
  map_server::MapStore& store() { return map_server_->store(); }
  // Returns the last session of the map to localize in; kNoSession if there is no such map.
  int64_t earlier_sessions() const { return earlier_sessions_; }
  std::optional<double> localized_after_s() const { return map_server_->localized_after_s(); }
  // Returns the recording, so that its images can be read again after the replay.
  camera_driver::ImageSource& recording();
  // Returns the CPU seconds of each component so far.
  std::map<std::string, double> cpu_s() const;
  // Returns the same CPU seconds by component and stage.
  std::map<std::string, std::map<std::string, double>> cpu_s_by_stage() const;
  // Returns the images that the recording left out, and those that front_tracker refused or found to be repeated.
  camera_driver::SkippedFrames skipped() const;
  // Returns the number of images for which front_tracker tried to find a pose.
  int64_t decoded() const;
  // Says that the map to localize in was made with another calibration of this recording; empty: it was not.
  const std::string& calibration_doubt() const { return map_server_->calibration_doubt(); }
  // Returns a line for each component that threw an exception.
  std::vector<std::string> broken() const;
  std::vector<ChannelCounts> channel_counts() const { return bus_.counts(); }

 private:
  struct Component {
    std::string name;
    double cpu_s = 0;
    std::map<std::string, double> stages_before;  // CPU seconds of earlier replays in this process
    std::unique_ptr<MeteredBus> bus;
    std::unique_ptr<SafeNode> node;
  };
  template <class NodeType, class... Arguments>
  NodeType* add(const std::string& name, const Arguments&... arguments);
  void settle();
  void ruminate_again();

  MemoryBus bus_;
  viewer_offscreen::ViewerOptions viewer_;
  std::vector<std::unique_ptr<Component>> components_;  // in the order in which they are ended
  camera_driver::CameraNode* camera_ = nullptr;
  front_tracker::FrontTrackerNode* front_tracker_ = nullptr;
  map_server::MapServerNode* map_server_ = nullptr;
  ruminator::RuminatorNode* ruminator_ = nullptr;  // null: it rebuilds nothing, or the map stays as it is
  int again_images_ = 0;
  const std::atomic<bool>* stop_ = nullptr;
  int64_t earlier_sessions_ = map_server::kNoSession;
  int64_t frames_ = 0;
  int64_t clock_ahead_us_ = 0;  // the bus's clock minus the images' times
  int64_t last_utime_us_ = 0;
  std::unique_ptr<LogWriter> log_;
};

}  // namespace rumi::tool
