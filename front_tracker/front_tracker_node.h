// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/running/due.h"
#include "base/running/failures.h"
#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/wire/image_masks.h"
#include "front_tracker/back_submap_fetcher.h"
#include "front_tracker/mask_publisher.h"
#include "front_tracker/options.h"
#include "front_tracker/repeated_images.h"
#include "front_tracker/session_gate.h"
#include "front_tracker/submap_publisher.h"
#include "front_tracker/track_publisher.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi::front_tracker {

// Takes CAMERA, RUMI_MAP_STATUS and RUMI_MAP_CHUNK; publishes RUMI_TRACK, CAMERA_TO_SUBMAP, CAMERA_TO_MAP,
// RUMI_MAP_POSE, RUMI_SUBMAP and RUMI_MAP_REQUEST. The calibration comes with the images unless `camera` is given.
class FrontTrackerNode : public Node {
 public:
  FrontTrackerNode(Bus& bus, const FrontTrackerOptions& options, const std::optional<Camera>& camera = std::nullopt);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  const RefusedImages& refused() const { return gate_.refused(); }
  const RepeatedImages& repeated() const { return repeated_; }
  void finish() override;
  std::string waits_for() const override;
  // Returns sentences about many images refused, dropped or repeated, and about a session in which no image got a pose.
  std::vector<std::string> complaints() const override;
  int64_t handed_on() const override { return publisher_.handed_on(); }

  // Gives new sessions higher numbers than `session`, because the map that they join may contain that number.
  void begin_sessions_after(int64_t session) { session_ = std::max(session_, session); }

  // Returns nullptr before the first usable image.
  Tracker* tracker() { return tracker_.get(); }

 private:
  bool on_message(std::span<const uint8_t> data);  // returns false if it is not an image, or has no time
  void on_image(ArrivedImage arrived);
  void on_map_status(const map_status_t& status);
  void track(const ArrivedImage& arrived, const Camera& camera);
  // Decodes the image to grey at the tracker's working size. If its data are damaged, reports that to gate_ and returns
  // an empty Mat.
  cv::Mat decode(const image_t& image, const Camera& camera);
  std::optional<TrackResult> pose_of(const image_t& image, const cv::Mat& grey);
  // Returns the mask that comes with the image. If it cannot be used, returns a mask that leaves out nothing; the first
  // time, a warning says so.
  const ImageMask& mask_of(const image_t& image, const cv::Size& size);
  void publish(const image_t& image, const TrackResult& result, double cpu_ms);
  void publish_in_map(const TrackResult& r);
  void begin_session(const Camera& camera, const image_t& image);
  void retire_session();
  void tell_of_silence(int64_t now_us);
  ChannelCounts images() const;  // returns the counts of the images that came
  void note_broken_mapping();

  Bus& bus_;
  std::optional<int64_t> silent_since_us_;  // nullopt: images have come, or the user was told that none come
  bool has_posed_ = false;
  NewestSender map_states_{"RUMI_MAP_STATUS", kLateUs};
  FrontTrackerOptions options_;
  SessionGate gate_;
  int64_t let_go_us_ = kNever_us;  // when the keyframes' memory was let go last
  int64_t session_ = 0;
  int64_t session_stream_ = 0;  // stream of the session's images
  std::unique_ptr<Tracker> tracker_;
  std::vector<std::unique_ptr<Tracker>> retired_;  // trackers of earlier sessions, until map_server has all their
                                                   // submaps
  MaskReader masks_;
  RepeatedImages repeated_;
  SubmapPublisher publisher_;
  TrackPublisher tracks_;
  MaskPublisher mask_publisher_;
  std::optional<BackSubmapFetcher> back_submaps_;  // nullopt if no back submaps are to be kept
  MapOverview map_;
  struct PlaceInMap {
    Sim3 map_from_submap;
    int64_t revision = 0;
  };
  std::map<SubmapKey, PlaceInMap> places_;  // the submaps in the served map
  bool finishing_ = false;
  bool told_of_mask_ = false;
  Failures broken_mapping_{"mapping of a keyframe"};
  TrackingState state_ = TrackingState::kNotInitialized;
  double cpu_ms_ = 0;
  int cpu_count_ = 0;
};

}  // namespace rumi::front_tracker
