// SPDX-License-Identifier: BSD-3-Clause
// All five components on one bus in one thread, in lockstep with the images: as fast as the machine goes, and with the
// same result to the bit however fast that is.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/process/safe_node.h"
#include "bus/transport/log_file.h"
#include "bus/transport/memory_bus.h"
#include "map_server/map_server_node.h"
#include "map_server/outputs/writers.h"
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
  int64_t frames = 0;                  // images published
  int64_t total = -1;                  // that there are, where the input tells
  int64_t utime_us = 0;                // of the last one
  std::function<std::string()> state;  // what front_tracker says of itself
};

struct ReplayHooks {
  std::function<void(const ruminator::WindowJob&)> on_window;  // every window, complete
  std::function<void(const ruminator::RuminationWindow&, const ruminator::BuildResult&)> on_rebuilt;
  const std::atomic<bool>* stop = nullptr;  // calls off the rebuilding of windows where it becomes true; may be null
};

class Replay {
 public:
  // Throws std::runtime_error with a message for the user (input, calibration, ...). Of the options, those that belong
  // to a live system are overruled: no threads, no database file (but that to localize in is read), no spool, and
  // no pictures unless a series of them or a log is asked for.
  Replay(const AllOptions& options, const std::string& input, const ReplayHooks& hooks = {});
  ~Replay();

  // Writes all messages from now on, pictures among them, into an lcm log, except the chunks of submaps and maps: what
  // they carry is in the outputs. Call it before the first step. Empty, or why the file cannot be written.
  std::string record(const std::string& log_file);
  // Ends the log. Empty, or why it is not complete (file, reason).
  std::string close_log();

  // Publishes the next image and lets every component do all that follows from it. False when the input has ended.
  bool step();
  // Ends everything in order and returns when nothing is left to do. Who was not finished after a minute of logical
  // time, and with what; empty: all were.
  std::string finish();

  ReplayProgress progress();
  const map_server::Atlas& atlas() const { return map_server_->atlas(); }
  map_server::MapStore& store() { return map_server_->store(); }
  // The last session that was there before: of the map to localize in.
  int64_t earlier_sessions() const { return earlier_sessions_; }
  std::optional<double> localized_after_s() const { return map_server_->localized_after_s(); }
  // The recording, to look at its images again when all were played.
  camera_driver::ImageSource& recording();
  // CPU seconds of each component so far.
  std::map<std::string, double> cpu_s() const;
  // The same by stage.
  std::map<std::string, std::map<std::string, double>> cpu_s_by_stage() const;
  // Of the recording, and what front_tracker refused or found repeated.
  camera_driver::SkippedFrames skipped() const;
  // Images of which front_tracker had a pose to find.
  int64_t decoded() const;
  // That the map to localize in has another calibration of this recording; empty: it has not.
  const std::string& calibration_doubt() const { return map_server_->calibration_doubt(); }
  // A line for each component that threw on the way.
  std::vector<std::string> broken() const;
  std::vector<ChannelCounts> channel_counts() const { return bus_.counts(); }

 private:
  struct Component {
    std::string name;
    double cpu_s = 0;
    std::map<std::string, double> stages_before;  // of earlier replays by this process
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
  double again_s_ = 0;
  const std::atomic<bool>* stop_ = nullptr;
  int64_t earlier_sessions_ = map_server::kNoSession;
  int64_t frames_ = 0;
  int64_t clock_ahead_us_ = 0;  // of the images' times
  int64_t last_utime_us_ = 0;
  std::unique_ptr<LogWriter> log_;
};

}  // namespace rumi::tool
