// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/running/stage_clock.h"
#include "camera_driver/camera_node.h"
#include "camera_driver/open_source.h"
#include "formats/camera/given_camera.h"
#include "formats/times/timestamps.h"
#include "front_tracker/front_tracker_node.h"
#include "rumi/run/again.h"
#include "rumi/run/metered_bus.h"
#include "ruminator/colmap_builder.h"
#include "ruminator/ruminator_node.h"
#include "viewer_offscreen/viewer_node.h"

namespace rumi::tool {
namespace {

using Refused = front_tracker::RefusedImages::Kind;

constexpr int64_t kFinishStepUs = 100'000;
constexpr int64_t kFinishTimeoutUs = 60'000'000;

}  // namespace

template <class NodeType, class... Arguments>
NodeType* Replay::add(const std::string& name, const Arguments&... arguments) {
  auto component = std::make_unique<Component>();
  component->name = name;
  component->stages_before = stage_cpu_s(name);
  component->bus = std::make_unique<MeteredBus>(bus_, &component->cpu_s);
  auto node = std::make_unique<NodeType>(*component->bus, arguments...);
  NodeType* result = node.get();
  component->node = std::make_unique<SafeNode>(std::move(node), &component->bus->broken_handlers());
  components_.push_back(std::move(component));
  return result;
}

Replay::Replay(const AllOptions& options, const std::string& input, const ReplayHooks& hooks) {
  front_tracker::FrontTrackerOptions front_tracker = options.front_tracker;
  front_tracker.mapping_thread = false;
  map_server::MapServerOptions map_server = options.map_server;
  if (!map_server.localize_only) map_server.database = ":memory:";
  map_server.merge.thread = false;
  if (camera_driver::is_camera(input))
    throw std::runtime_error(camera_driver::open_recording(input, options.camera_driver).error_text());
  camera_ = add<camera_driver::CameraNode>("camera_driver", input, options.camera_driver);
  auto* tracker = add<front_tracker::FrontTrackerNode>("front_tracker", front_tracker,
                                                       read_given_camera(front_tracker.camera_file));
  front_tracker_ = tracker;
  ruminator::RuminatorOptions ruminator = options.ruminator;
  ruminator.build_thread = false;
  ruminator.spool.clear();
  ruminator::RuminatorHooks ruminator_hooks;
  ruminator_hooks.on_job = hooks.on_window;
  ruminator_hooks.on_built = hooks.on_rebuilt;
  if (ruminator.rebuild) ruminator_hooks.use(ruminator::colmap_builder(ruminator.build));
  if (hooks.stop && ruminator.rebuild)
    ruminator_hooks.builder = [build = ruminator_hooks.builder, stop = hooks.stop](
                                  const auto& job, const std::string& folder, const auto& progress,
                                  const std::atomic<bool>&) { return build(job, folder, progress, *stop); };
  auto* rebuilding =
      add<ruminator::RuminatorNode>("ruminator", ruminator, ruminator_hooks, read_given_camera(ruminator.camera_file));
  if (ruminator.rebuild && !map_server.localize_only) ruminator_ = rebuilding;
  again_images_ = map_server.merge.enabled ? ruminator.again_images : 0;  // only what is joined is won
  stop_ = hooks.stop;
  map_server_ = add<map_server::MapServerNode>("map_server", map_server);
  // Sessions are ordered by their numbers, which are times. A recording's times may be earlier than the map's (they may
  // count from 0), so the sessions of this run get later numbers.
  if (const auto& submaps = map_server_->atlas().submaps(); !submaps.empty()) {
    earlier_sessions_ = submaps.rbegin()->first.session;
    tracker->begin_sessions_after(earlier_sessions_);
  }
  viewer_ = options.viewer_offscreen;
  viewer_.series_goes_on = false;
  if (viewer_.series) add<viewer_offscreen::ViewerNode>("viewer_offscreen", viewer_);
}

Replay::~Replay() = default;

Result<> Replay::record(const std::string& log_file) {
  if (!viewer_.series) {
    viewer_.output.clear();
    add<viewer_offscreen::ViewerNode>("viewer_offscreen", viewer_);
  }
  log_ = std::make_unique<LogWriter>(log_file);
  bus_.set_tap([this](const std::string& channel, std::span<const uint8_t> data) {
    const bool is_chunk = channel == channels::kSubmap || channel == channels::kSubmapAck ||
                          channel == channels::kMapChunk || channel == channels::kMapAck;
    if (!is_chunk) log_->write(bus_.now_us(), channel, data);
    return true;
  });
  if (!log_->error().empty()) return Error{log_->error()};
  return {};
}

Result<> Replay::close_log() {
  if (!log_) return {};
  bus_.set_tap(nullptr);
  const std::unique_ptr<LogWriter> log = std::move(log_);
  if (!log->close()) return Error{log->error()};
  return {};
}

// Lets every component handle its messages and do what is due, until no message is left.
void Replay::settle() {
  bus_.dispatch();
  for (const auto& component : components_) {
    {
      const CpuTimer timer(&component->cpu_s);
      component->node->tick(bus_.now_us());
    }
    bus_.dispatch();
  }
}

bool Replay::step() {
  Component& camera = *components_.front();
  std::optional<int64_t> utime_us;
  {
    const CpuTimer timer(&camera.cpu_s);
    utime_us = camera_->next_utime_us();
    if (!utime_us) return false;
    // If the recording's times go back, the bus's clock goes on.
    if (*utime_us < last_utime_us_) clock_ahead_us_ += last_utime_us_ - *utime_us + kUsualPeriodUs;
    bus_.set_now_us(*utime_us + clock_ahead_us_);
    camera_->publish_next();
  }
  ++frames_;
  last_utime_us_ = *utime_us;
  settle();
  return true;
}

void Replay::ruminate_again() {
  const auto settle_all = [this] {
    const int64_t deadline_us = bus_.now_us() + kFinishTimeoutUs;
    do {
      bus_.set_now_us(bus_.now_us() + kFinishStepUs);
      settle();
    } while ((!ruminator_->finished() || !map_server_->all_is_joined()) && bus_.now_us() < deadline_us);
  };
  const auto others_cpu_s = [this] {
    double counted_s = 0;
    for (const auto& component : components_) counted_s += component->cpu_s;
    return process_cpu_s() - counted_s;
  };
  const double before_s = others_cpu_s();
  Again({.atlas = atlas(), .recording = recording(), .ruminator = *ruminator_, .settle = settle_all, .stop = stop_})
      .run(again_images_);
  const auto ruminator = std::find_if(components_.begin(), components_.end(),
                                      [](const auto& component) { return component->name == "ruminator"; });
  (*ruminator)->cpu_s += others_cpu_s() - before_s;
}

std::string Replay::finish() {
  int64_t deadline_us = bus_.now_us() + kFinishTimeoutUs;
  std::string unfinished;
  for (const auto& component : components_) {
    {
      const CpuTimer timer(&component->cpu_s);
      component->node->finish();
    }
    settle();
    // The components end one after another: the next one must still handle what this one sends at its end.
    while (!component->node->finished() && bus_.now_us() < deadline_us) {
      bus_.set_now_us(bus_.now_us() + kFinishStepUs);
      settle();
    }
    if (component->name == "ruminator" && ruminator_ && again_images_ > 0) {
      ruminate_again();
      deadline_us = bus_.now_us() + kFinishTimeoutUs;
    }
    if (const std::string what = component->node->waits_for(); !what.empty())
      unfinished += fmt::format("{}{}: {}", unfinished.empty() ? "" : "; ", component->name, what);
  }
  return unfinished;
}

ReplayProgress Replay::progress() {
  return {frames_, camera_->source().total(), last_utime_us_, [this] { return front_tracker_->status().detail; }};
}

std::vector<std::string> Replay::broken() const {
  std::vector<std::string> lines;
  for (const auto& component : components_)
    for (const Failures* failures :
         std::initializer_list<const Failures*>{&component->node->failures(), &component->bus->broken_handlers()})
      if (failures->count() > 0) lines.push_back(component->name + ": " + failures->text());
  return lines;
}

int64_t Replay::decoded() const {
  const front_tracker::RefusedImages& refused = front_tracker_->refused();
  return frames_ - refused.of(Refused::kDamaged) - refused.of(Refused::kSize) - front_tracker_->repeated().still();
}

camera_driver::ImageSource& Replay::recording() { return camera_->source(); }

camera_driver::SkippedFrames Replay::skipped() const {
  camera_driver::SkippedFrames skipped = camera_->source().skipped();
  skipped.unreadable += front_tracker_->refused().of(Refused::kDamaged);
  skipped.wrong_size += front_tracker_->refused().of(Refused::kSize);
  const front_tracker::RepeatedImages& repeated = front_tracker_->repeated();
  skipped.repeated = repeated.still();
  skipped.longest_row = repeated.longest().images;
  skipped.longest_row_s = repeated.longest().begin_s;
  return skipped;
}

std::map<std::string, std::map<std::string, double>> Replay::cpu_s_by_stage() const {
  std::map<std::string, std::map<std::string, double>> cpu_s;
  for (const auto& component : components_) {
    std::map<std::string, double>& stages = cpu_s[component->name] = stage_cpu_s(component->name);
    for (const auto& [stage, before_s] : component->stages_before) stages[stage] -= before_s;
  }
  return cpu_s;
}

std::map<std::string, double> Replay::cpu_s() const {
  std::map<std::string, double> cpu_s;
  for (const auto& component : components_) cpu_s[component->name] = component->cpu_s;
  return cpu_s;
}

}  // namespace rumi::tool
