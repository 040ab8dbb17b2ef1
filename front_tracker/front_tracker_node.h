// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/running/failures.h"
#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/wire/image_masks.h"
#include "front_tracker/back_submap_fetcher.h"
#include "front_tracker/image_times.h"
#include "front_tracker/mask_publisher.h"
#include "front_tracker/options.h"
#include "front_tracker/refused_images.h"
#include "front_tracker/repeated_images.h"
#include "front_tracker/submap_publisher.h"
#include "front_tracker/track_publisher.h"
#include "front_tracker/tracking/tracker.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::front_tracker {

// CAMERA, RUMI_MAP_STATUS and RUMI_MAP_CHUNK in; RUMI_TRACK, CAMERA_TO_SUBMAP, CAMERA_TO_MAP, RUMI_MAP_POSE,
// RUMI_SUBMAP and RUMI_MAP_REQUEST out. The calibration comes with the images unless
// `camera` is given.
class FrontTrackerNode : public Node {
 public:
  FrontTrackerNode(Bus& bus, const FrontTrackerOptions& options, const std::optional<Camera>& camera = std::nullopt);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  const RefusedImages& refused() const { return refused_; }
  const RepeatedImages& repeated() const { return repeated_; }
  void finish() override;
  std::string waits_for() const override;
  // Of many images that were refused, dropped or repeated; or that none got a pose.
  std::vector<std::string> complaints() const override;
  int64_t handed_on() const override { return publisher_.handed_on(); }

  // Sessions get higher numbers than this one: a map that they come into may have it.
  void begin_sessions_after(int64_t session) { session_ = std::max(session_, session); }

  // Nothing before the first usable image.
  Tracker* tracker() { return tracker_.get(); }

 private:
  bool on_message(std::span<const uint8_t> data);  // false: it has no image, or one without a time
  void on_image(const image_t& image, int64_t arrived_us);
  void on_map_status(const map_status_t& status);
  // The image as the tracker wants it; an empty Mat, and a problem noted, if it cannot be used.
  cv::Mat usable_image(const image_t& image, int64_t arrived_us);
  bool has_usable_time(const image_t& image, int64_t arrived_us);
  std::optional<TrackResult> take(const image_t& image, const cv::Mat& grey);
  // What the image says of itself; everything, and a problem noted, if that cannot be used.
  const ImageMask& mask_of(const image_t& image, const cv::Size& size);
  void retire_session();
  void tell_of_silence(int64_t now_us);
  ChannelCounts images() const;  // that came
  void note_broken_mapping();
  // That of the session, or of the one that this image may begin; nothing, and a problem noted, if it does not tell or
  // is another camera's.
  std::optional<Camera> camera_of(const image_t& image, int64_t arrived_us);
  // Of an image of which the next ones tell: those in a row are the first of a session, or are refused.
  void wait(RefusedImages::Kind kind, const image_t& image, int64_t arrived_us, const std::string& problem);
  void wait_as_foreign(const image_t& image, int64_t arrived_us, const std::string& problem);
  void wait_for_times(const image_t& image, int64_t arrived_us);
  void give_up_waiting();
  void take_waiting();
  void end_session(const std::string& reason);
  bool is_of_another_stream(const image_t& image) const;
  void begin_session(const Camera& camera, const image_t& image);
  void publish_in_map(const TrackResult& r);
  void refuse(RefusedImages::Kind kind, const std::string& problem);

  Bus& bus_;
  int64_t silent_since_us_ = 0;  // 0: images have come, or it was said that none do
  bool has_posed_ = false;
  NewestSender map_states_{"RUMI_MAP_STATUS", kLateUs};
  FrontTrackerOptions options_;
  std::optional<Camera> given_camera_;
  Camera image_camera_;              // of the session's images; the tracker's may be smaller
  std::string session_calibration_;  // as it came with them
  int64_t session_stream_ = 0;       // of its images
  std::unique_ptr<Tracker> tracker_;
  std::vector<std::unique_ptr<Tracker>> retired_;  // of earlier sessions, until map_server has all of them
  MaskReader masks_;
  RepeatedImages repeated_;
  SubmapPublisher publisher_;
  TrackPublisher tracks_;
  MaskPublisher mask_publisher_;
  std::optional<BackSubmapFetcher> back_submaps_;  // unless none are to be kept
  MapOverview map_;
  struct PlaceInMap {
    Sim3 map_from_submap;
    int64_t revision = 0;
  };
  std::map<SubmapKey, PlaceInMap> places_;  // of the submaps in the served map
  int64_t session_ = 0;
  ImageTimes times_;
  bool finishing_ = false;

  struct Waiting {
    image_t image;
    int64_t arrived_us = 0;
  };
  std::vector<Waiting> waiting_;  // in a row
  RefusedImages::Kind waiting_kind_ = RefusedImages::Kind::kNoTime;
  std::string waiting_problem_;
  bool told_of_mask_ = false;
  std::string problem_;  // of the last image, empty if it was good
  RefusedImages refused_;
  Failures broken_mapping_{"mapping of a keyframe"};
  TrackingState state_ = TrackingState::kNotInitialized;
  double cpu_ms_ = 0;
  int cpu_count_ = 0;
};

}  // namespace rumi::front_tracker
