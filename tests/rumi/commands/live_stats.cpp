// SPDX-License-Identifier: BSD-3-Clause
// Listens to a live system. When it is ended, prints as JSON what an outsider saw: the number of images and their MB
// per second, datagrams that were lost on the way to it, the number of answers, the time from the arrival of an image
// to the arrival of its pose, the times of the first image and the first answer after the start of front_tracker, the
// peak memory of each process, and the time that each stage took (stages_ms).
#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bus/process/process.h"
#include "bus/transport/receive_losses.h"
#include "lcmtypes/rumi/chunk_ack_t.hpp"
#include "lcmtypes/rumi/chunk_t.hpp"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"

namespace {

// Returns the microseconds since a process of this computer was started, in steps of 10 ms. Absent if it has ended.
std::optional<int64_t> age_us(int pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string stat;
  if (!std::getline(file, stat)) return std::nullopt;
  // The name of the process may contain spaces and brackets.
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  std::string skipped;
  for (int field = 3; field < 22; ++field) fields >> skipped;
  int64_t start_ticks = 0;
  fields >> start_ticks;
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return now.tv_sec * 1'000'000 + now.tv_nsec / 1000 - start_ticks * 1'000'000 / sysconf(_SC_CLK_TCK);
}

std::optional<double> peak_memory_mb(int pid) {
  std::ifstream file(fmt::format("/proc/{}/status", pid));
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) * 1.024e-3;
  return std::nullopt;
}

class Durations {
 public:
  void add_ms(double ms) { ms_.push_back(ms); }
  void add_us(int64_t us) { add_ms(static_cast<double>(us) * 1e-3); }
  // Sorts the durations, and returns the quantile in ms; null if there are none.
  nlohmann::ordered_json at(double quantile) {
    if (ms_.empty()) return {};
    std::sort(ms_.begin(), ms_.end());
    return ms_[static_cast<size_t>(quantile * static_cast<double>(ms_.size() - 1))];
  }
  nlohmann::ordered_json summary() {
    return {{"n", ms_.size()}, {"p50", at(0.50)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"max", at(1.0)}};
  }

 private:
  std::vector<double> ms_;
};

class LiveStats : public rumi::Node {
 public:
  LiveStats(rumi::Bus& bus, const rumi::ReceiveLosses& losses) : bus_(bus), losses_(losses) {
    // The queues are deep, because messages lost here would count as lost by the system.
    bus.subscribe<rumi::image_t>(rumi::channels::kCamera, {1000}, [this](const rumi::image_t& image) {
      if (++images_ == 1) first_image_us_ = bus_.now_us();
      last_image_us_ = bus_.now_us();
      image_bytes_ += static_cast<int64_t>(image.data.size());
      image_arrived_us_[image.utime] = bus_.now_us();
    });
    bus.subscribe<rumi::track_t>(rumi::channels::kTrack, {1000},
                                 [this](const rumi::track_t& track) { on_track(track); });
    bus.subscribe<rumi::process_status_t>(rumi::channels::kStatus, {1000},
                                          [this](const rumi::process_status_t& status) { on_status(status); });
    bus.subscribe<rumi::rigid_transform_t>(rumi::channels::kCameraToMap, {1000},
                                           [this](const rumi::rigid_transform_t& pose) {
                                             const auto image = image_arrived_us_.find(pose.utime);
                                             if (image != image_arrived_us_.end())
                                               to_map_pose_.add_us(bus_.now_us() - image->second);
                                           });
    bus.subscribe<rumi::chunk_t>(rumi::channels::kSubmap, {1000}, [this](const rumi::chunk_t& chunk) {
      update_began_us_.try_emplace({chunk.sender, chunk.transfer_id}, bus_.now_us());
    });
    bus.subscribe<rumi::chunk_ack_t>(rumi::channels::kSubmapAck, {1000}, [this](const rumi::chunk_ack_t& ack) {
      const auto began = update_began_us_.find({ack.sender, ack.transfer_id});
      if (ack.status != rumi::chunk_ack_t::COMPLETE || began == update_began_us_.end()) return;
      to_stored_.add_us(bus_.now_us() - began->second);
      update_began_us_.erase(began);
    });
  }
  void tick(int64_t) override {}
  rumi::NodeStatus status() override { return {}; }
  void finish() override {
    const nlohmann::ordered_json json{
        {"images", images_},
        {"image_mb_per_s", image_mb_per_s()},
        {"datagrams_lost", losses_.datagrams()},
        {"answers", answers_},
        {"answers_lost", answers_lost_},
        {"tracked", tracked_},
        {"latency_p50_ms", to_pose_.at(0.50)},
        {"latency_p95_ms", to_pose_.at(0.95)},
        {"latency_max_ms", to_pose_.at(1.0)},
        {"first_image_ms", after_start(first_image_us_)},
        {"first_answer_ms", after_start(first_answer_us_)},
        {"peak_memory_mb", peak_memory_mb_},
        {"stages_ms", stages()},
    };
    fmt::print("{}\n", json.dump());
  }

 private:
  nlohmann::ordered_json stages() {
    nlohmann::ordered_json stages{{"image to RUMI_TRACK", to_pose_.summary()},
                                  {"image to CAMERA_TO_MAP", to_map_pose_.summary()},
                                  {"CPU of front_tracker for an image", pose_cpu_.summary()},
                                  {"submap update to stored", to_stored_.summary()}};
    for (auto& [process, mean] : processing_) stages["mean of a second, " + process] = mean.summary();
    return stages;
  }
  double image_mb_per_s() const {
    if (images_ < 2) return 0;
    const auto us = static_cast<double>(last_image_us_ - *first_image_us_);
    return static_cast<double>(image_bytes_) / us * static_cast<double>(images_ - 1) / static_cast<double>(images_);
  }
  void on_track(const rumi::track_t& track) {
    if (track.sequence <= last_sequence_) return;  // an earlier frame that got its pose afterwards
    if (++answers_ == 1) first_answer_us_ = bus_.now_us();
    if (track.state == rumi::track_t::TRACKING) ++tracked_;
    if (last_sequence_ >= 0) answers_lost_ += track.sequence - last_sequence_ - 1;
    last_sequence_ = track.sequence;
    pose_cpu_.add_ms(track.processing_ms);
    const auto image = image_arrived_us_.find(track.utime);
    if (image == image_arrived_us_.end()) return;
    to_pose_.add_us(bus_.now_us() - image->second);
    image_arrived_us_.erase(image_arrived_us_.begin(), image);  // keeps the image itself: CAMERA_TO_MAP comes later
  }
  void on_status(const rumi::process_status_t& status) {
    if (const auto mb = peak_memory_mb(status.pid)) peak_memory_mb_[status.process] = *mb;
    if (status.processing_ms > 0) processing_[status.process].add_ms(status.processing_ms);
    if (status.process != "front_tracker" || tracker_started_us_) return;
    if (const auto age = age_us(status.pid)) tracker_started_us_ = bus_.now_us() - *age;
  }
  nlohmann::ordered_json after_start(const std::optional<int64_t>& at_us) const {
    if (!at_us || !tracker_started_us_) return {};
    return static_cast<double>(*at_us - *tracker_started_us_) * 1e-3;
  }
  rumi::Bus& bus_;
  const rumi::ReceiveLosses& losses_;
  int64_t images_ = 0, image_bytes_ = 0, last_image_us_ = 0, answers_ = 0, answers_lost_ = 0, tracked_ = 0,
          last_sequence_ = -1;
  std::map<int64_t, int64_t> image_arrived_us_;                         // by utime
  std::map<std::pair<std::string, int64_t>, int64_t> update_began_us_;  // by sender and transfer
  Durations to_pose_, to_map_pose_, pose_cpu_, to_stored_;
  std::map<std::string, Durations> processing_;
  std::optional<int64_t> first_image_us_, first_answer_us_, tracker_started_us_;
  std::map<std::string, double> peak_memory_mb_;  // by process, as of its last status
};

}  // namespace

int main(int argc, char** argv) {
  const rumi::ReceiveLosses losses;
  rumi::ProcessDescription process;
  process.name = "live_stats";
  process.summary = "Prints what an outsider saw of a live system.";
  process.make_node = [&losses](rumi::Bus& bus) { return std::make_unique<LiveStats>(bus, losses); };
  return rumi::run_process(argc, argv, process);
}
