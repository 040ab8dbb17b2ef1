// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/live_status.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/json_text.h"
#include "bus/process/only_one.h"
#include "bus/wire/tracking_state.h"
#include "slam/map/tracking_state.h"

namespace rumi::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kRecentUs = 5'000'000;  // time over which rates are computed
constexpr int64_t kShortestUs = 500'000;  // over less time a rate is chance: waiting messages arrive at once
constexpr int64_t kSilentUs = 3'000'000;  // then a process is silent: each tells its status once a second
constexpr std::array kProcessStates = {"starting", "running", "degraded", "stopping"};
constexpr std::array kWindowStates = {"collecting", "queued",    "extracting", "matching",
                                      "mapping",    "published", "failed"};

template <size_t N>
const char* name_of(const std::array<const char*, N>& names, int state) {
  return state >= 0 && state < static_cast<int>(N) ? names[static_cast<size_t>(state)] : "unknown";
}

double rounded(double value) { return std::round(value * 10) / 10; }

double per_second(double amount, int64_t span_us) {
  return span_us >= kShortestUs ? rounded(amount * 1e6 / static_cast<double>(span_us)) : 0;
}

// Returns 0 if no value is finite.
double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });  // NaN cannot be sorted
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return rounded(values[static_cast<size_t>(q * static_cast<double>(values.size() - 1))]);
}

// True for a plausible number of messages, frames or bytes: sums and differences of such numbers cannot overflow.
bool is_count(int64_t n) { return n >= 0 && n < int64_t{1} << 45; }

bool is_possible(const process_status_t& status) {
  return plausible_utime(status.started_utime) && is_count(status.messages_in) && is_count(status.messages_out) &&
         std::all_of(status.channels.begin(), status.channels.end(), [](const channel_count_t& channel) {
           return is_count(channel.dropped) && is_count(channel.undecodable) && channel.queue_depth >= 0;
         });
}

// Returns a line with the stages that take most CPU time.
std::string stages_text(const Json& cpu_ms) {
  constexpr size_t kLongest = 100;
  std::vector<std::pair<double, std::string>> stages;
  for (const auto& [stage, ms] : cpu_ms.items())
    if (ms.get<double>() > 0) stages.emplace_back(-ms.get<double>(), stage);
  std::sort(stages.begin(), stages.end());
  std::string line;
  for (const auto& [ms, stage] : stages) {
    const std::string next = fmt::format("{}{} {:.1f}", line.empty() ? "  CPU ms/frame: " : ", ", stage, -ms);
    if (line.size() + next.size() > kLongest) break;
    line += next;
  }
  return line.empty() ? line : line + '\n';
}

std::string process_text(const std::string& name, const Json& p) {
  std::string text = fmt::format("{:<18}{:<10}{:>8.1f}{:>8.1f}{:>9}{:>9}{:>8.1f}{:>10}{:>9.1f}\n", name,
                                 p["state"].get<std::string>(), p["in_hz"].get<double>(), p["out_hz"].get<double>(),
                                 p["dropped"].get<int64_t>() + p["undecodable"].get<int64_t>(),
                                 p["waiting"].get<int64_t>(), p["cpu_percent"].get<double>(),
                                 p["cpu_ms_per_frame"].is_null() ? "-" : json_text(p["cpu_ms_per_frame"]),
                                 p["memory_mb"].get<double>());
  text += stages_text(p["cpu_ms_per_frame_by_stage"]);
  const bool says_why = p["state"] == "degraded" || name == "camera_driver";
  if (says_why) text += fmt::format("  {}\n", p["detail"].get<std::string>());
  return text;
}

}  // namespace

LiveStatus::LiveStatus(Bus& bus) : bus_(bus) {
  bus.subscribe<process_status_t>(channels::kStatus, {}, [this](const process_status_t& m) { on_status(m); });
  bus.subscribe<track_t>(channels::kTrack, {}, [this](const track_t& m) { on_track(m); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {}, [this](const map_status_t& m) {
    if (map_states_.take(m.utime, bus_.now_us())) map_ = m;
  });
  bus.subscribe<window_t>(channels::kWindow, {}, [this](const window_t& m) { windows_[{m.session, m.window_id}] = m; });
}

void LiveStatus::on_status(const process_status_t& status) {
  if (!is_possible(status) || status.process == kAsksEverybody) return;
  Process& process = processes_[status.process];
  if (!process.states.take(status.utime, bus_.now_us())) return;
  const bool same_run = process.latest.pid == status.pid && process.latest.host == status.host;
  // A process also tells its status when it is asked, and at its end: too soon after the last one for a rate.
  if (same_run && status.utime - process.latest.utime >= kShortestUs) process.before = std::move(process.latest);
  if (!same_run) {
    process.before.reset();
    process.first = status;
    process.frames_at_first = frames_;
  }
  process.latest = status;
  process.frames_at_latest = frames_;
}

void LiveStatus::on_track(const track_t& track) {
  if (!is_count(track.sequence) || !sessions_.take(track.session, bus_.now_us())) return;
  const bool told_again = !tracks_.empty() && track.session == tracks_.back().track.session &&
                          track.sequence <= tracks_.back().track.sequence;
  if (told_again) return;
  ++frames_;
  tracks_.push_back({bus_.now_us(), track});
  while (tracks_.back().at_us - tracks_.front().at_us > kRecentUs) tracks_.pop_front();
}

// Returns the CPU ms per frame of each stage; an empty object before the first frame.
Json LiveStatus::stages_json(const Process& process) const {
  const int64_t frames = process.frames();
  Json stages = Json::object();
  if (frames <= 0) return stages;
  for (const stage_cost_t& stage : process.latest.stages) {
    double cpu_s = stage.cpu_s;
    for (const stage_cost_t& first : process.first.stages)
      if (first.stage == stage.stage) cpu_s -= first.cpu_s;
    stages[stage.stage] = rounded(1e3 * cpu_s / static_cast<double>(frames));
  }
  return stages;
}

Json LiveStatus::process_json(const Process& process) const {
  const process_status_t& now = process.latest;
  const process_status_t& before = process.before.value_or(now);
  const int64_t span_us = now.utime - before.utime, silent_us = bus_.now_us() - now.utime;
  const auto frames = static_cast<double>(process.frames());
  int64_t dropped = 0, undecodable = 0, waiting = 0;
  for (const channel_count_t& channel : now.channels) {
    dropped += channel.dropped;
    undecodable += channel.undecodable;
    waiting += channel.queue_depth;
  }
  return {{"state", silent_us > kSilentUs ? "silent" : name_of(kProcessStates, now.state)},
          {"in_hz", per_second(static_cast<double>(now.messages_in - before.messages_in), span_us)},
          {"out_hz", per_second(static_cast<double>(now.messages_out - before.messages_out), span_us)},
          {"dropped", dropped},
          {"undecodable", undecodable},
          {"waiting", waiting},
          {"processing_ms", rounded(now.processing_ms)},
          {"cpu_percent", per_second(100 * (now.cpu_s - before.cpu_s), span_us)},
          {"cpu_ms_per_frame", frames > 0 ? Json(rounded(1e3 * (now.cpu_s - process.first.cpu_s) / frames)) : Json()},
          {"cpu_ms_per_frame_by_stage", stages_json(process)},
          {"memory_mb", rounded(static_cast<double>(now.rss_bytes) / 1e6)},
          {"running_s", rounded(static_cast<double>(now.utime - now.started_utime) * 1e-6)},
          {"detail", now.detail}};
}

Json LiveStatus::tracking_json() const {
  const track_t& latest = tracks_.back().track;
  std::vector<double> latencies, costs;
  int64_t tracked = 0, lost_by_bus = 0;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const track_t& track = tracks_[i].track;
    latencies.push_back(track.latency_ms);
    costs.push_back(track.processing_ms);
    tracked += track.state == track_t::TRACKING;
    if (i > 0 && track.session == tracks_[i - 1].track.session)
      lost_by_bus += track.sequence - tracks_[i - 1].track.sequence - 1;
  }
  const auto frames = static_cast<double>(tracks_.size());
  return {{"state", to_string(state_from_wire(latest.state).value_or(TrackingState::kUnknown))},
          {"submap", latest.submap_id},
          {"inliers", latest.inliers},
          {"keypoints", latest.keypoints},
          {"rate_hz", per_second(frames - 1, tracks_.back().at_us - tracks_.front().at_us)},
          {"tracked_percent", rounded(100 * static_cast<double>(tracked) / frames)},
          {"latency_p50_ms", quantile(latencies, 0.5)},
          {"latency_p95_ms", quantile(latencies, 0.95)},
          {"processing_p50_ms", quantile(costs, 0.5)},
          {"lost_by_bus", lost_by_bus},
          {"frames", latest.sequence + 1}};
}

Json LiveStatus::map_json() const {
  return {{"revision", map_->map_revision},
          {"frames", map_->frames},
          {"frames_in_map", map_->frames_in_map},
          {"earlier_frames", map_->earlier_frames},
          {"localized_frames", map_->localized_frames},
          {"localized_after_s", map_->localized_after_s < 0 ? Json() : Json(rounded(map_->localized_after_s))},
          {"front_submaps", map_->front_submaps},
          {"back_submaps", map_->back_submaps},
          {"submaps_in_map", map_->submaps_in_map},
          {"keyframes", map_->keyframes},
          {"landmarks", map_->landmarks},
          {"links_accepted", map_->links_accepted},
          {"links_refused", int64_t{map_->links_in_all} - map_->links_accepted},
          {"merging", static_cast<bool>(map_->merging)},
          {"database_mb", rounded(static_cast<double>(map_->database_bytes) / 1e6)}};
}

Json LiveStatus::windows_json() const {
  Json windows = Json::array();
  for (const auto& [key, window] : windows_)
    windows.push_back({{"id", window.window_id},
                       {"state", name_of(kWindowStates, window.state)},
                       {"images", window.napproach + window.ngap + window.ndeparture},
                       {"progress", rounded(window.progress)},
                       {"reason", window.reason}});
  return windows;
}

Json LiveStatus::to_json() const {
  Json json = Json::object();
  json["processes"] = Json::object();
  for (const auto& [name, process] : processes_) json["processes"][name] = process_json(process);
  if (!tracks_.empty()) json["tracking"] = tracking_json();
  if (map_) json["map"] = map_json();
  if (!windows_.empty()) json["windows"] = windows_json();
  return json;
}

std::string LiveStatus::to_text() const {
  const Json json = to_json();
  std::string text = fmt::format("{:<18}{:<10}{:>8}{:>8}{:>9}{:>9}{:>8}{:>10}{:>9}\n", "process", "state", "in/s",
                                 "out/s", "dropped", "waiting", "CPU %", "ms/frame", "MB");
  for (const auto& [name, p] : json["processes"].items()) text += process_text(name, p);
  if (json.contains("tracking")) {
    const Json& t = json["tracking"];
    // The number of keypoints is left out. If landmarks are followed by their patches, it only counts the landmarks
    // found.
    text += fmt::format("\ntracking  {}, submap {}, {} landmarks agree with the pose\n", t["state"].get<std::string>(),
                        t["submap"].get<int>(), t["inliers"].get<int>());
    text +=
        fmt::format("          {:.1f} Hz, {:.0f} % tracked, latency p50 {:.1f} ms, p95 {:.1f} ms, {} frames so far\n",
                    t["rate_hz"].get<double>(), t["tracked_percent"].get<double>(), t["latency_p50_ms"].get<double>(),
                    t["latency_p95_ms"].get<double>(), t["frames"].get<int64_t>());
  }
  if (json.contains("map")) {
    const Json& m = json["map"];
    text +=
        fmt::format("map       {} of {} frames, {} of {} front and {} back submaps, {} keyframes, {} landmarks{}\n",
                    m["frames_in_map"].get<int64_t>(), m["frames"].get<int64_t>(), m["submaps_in_map"].get<int64_t>(),
                    m["front_submaps"].get<int64_t>(), m["back_submaps"].get<int64_t>(), m["keyframes"].get<int64_t>(),
                    m["landmarks"].get<int64_t>(), m["merging"].get<bool>() ? ", merging" : "");
  }
  if (json.contains("map") && map_->earlier_frames > 0)
    text += fmt::format("          {}: {} of {} frames of this run are in the map of {} frames of before\n",
                        map_->localized_frames > 0 ? "localized" : "not localized", map_->localized_frames,
                        map_->frames - map_->earlier_frames, map_->earlier_frames);
  if (json.contains("windows"))
    for (const Json& w : json["windows"])
      text += fmt::format("window {:<3}{}, {} images{}\n", w["id"].get<int>(), w["state"].get<std::string>(),
                          w["images"].get<int>(),
                          w["reason"].get<std::string>().empty() ? "" : ": " + w["reason"].get<std::string>());
  return text;
}

}  // namespace rumi::tool
