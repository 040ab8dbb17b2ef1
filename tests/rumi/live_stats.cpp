// SPDX-License-Identifier: BSD-3-Clause
// Listens to a live system and, when it is ended, prints as JSON what an outsider saw: images, answers to them, and how
// long an answer took from the arrival of the image to the arrival of its pose.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "bus/process.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"

namespace {

class LiveStats : public rumi::Node {
 public:
  explicit LiveStats(rumi::Bus& bus) : bus_(bus) {
    // Deep queues: what is lost here would be taken for a loss of the system.
    bus.subscribe<rumi::image_t>(rumi::channels::kCamera, {1000}, [this](const rumi::image_t& image) {
      ++images_;
      image_arrived_us_[image.utime] = bus_.now_us();
    });
    bus.subscribe<rumi::track_t>(rumi::channels::kTrack, {1000},
                                 [this](const rumi::track_t& track) { on_track(track); });
  }
  void tick(int64_t) override {}
  rumi::NodeStatus status() override { return {}; }
  void finish() override {
    std::sort(latencies_ms_.begin(), latencies_ms_.end());
    const nlohmann::ordered_json json{
        {"images", images_},         {"answers", answers_},        {"answers_lost", answers_lost_},
        {"tracked", tracked_},       {"latency_p50_ms", at(0.50)}, {"latency_p95_ms", at(0.95)},
        {"latency_max_ms", at(1.0)},
    };
    fmt::print("{}\n", json.dump());
  }

 private:
  void on_track(const rumi::track_t& track) {
    if (track.sequence <= last_sequence_) return;  // a frame that got its pose afterwards
    ++answers_;
    if (track.state == rumi::track_t::TRACKING) ++tracked_;
    if (last_sequence_ >= 0) answers_lost_ += track.sequence - last_sequence_ - 1;
    last_sequence_ = track.sequence;
    const auto image = image_arrived_us_.find(track.utime);
    if (image == image_arrived_us_.end()) return;
    latencies_ms_.push_back(static_cast<double>(bus_.now_us() - image->second) * 1e-3);
    image_arrived_us_.erase(image_arrived_us_.begin(), std::next(image));
  }
  nlohmann::ordered_json at(double quantile) const {
    if (latencies_ms_.empty()) return {};
    const auto last = static_cast<double>(latencies_ms_.size() - 1);
    return latencies_ms_[static_cast<size_t>(quantile * last)];
  }
  rumi::Bus& bus_;
  int64_t images_ = 0, answers_ = 0, answers_lost_ = 0, tracked_ = 0, last_sequence_ = -1;
  std::map<int64_t, int64_t> image_arrived_us_;  // by utime
  std::vector<double> latencies_ms_;
};

}  // namespace

int main(int argc, char** argv) {
  rumi::ProcessDescription process;
  process.name = "live_stats";
  process.summary = "Prints what an outsider saw of a live system.";
  process.make_node = [](rumi::Bus& bus) { return std::make_unique<LiveStats>(bus); };
  return rumi::run_process(argc, argv, process);
}
