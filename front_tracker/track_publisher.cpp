// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/track_publisher.h"

#include <charconv>
#include <string_view>

#include "bus/wire/image_codec.h"
#include "bus/wire/pose.h"
#include "bus/wire/tracking_state.h"

namespace rumi::front_tracker {
namespace {

// Returns the time from publication to pose if the driver says when it published, otherwise from capture to pose.
float latency_ms(const image_t& image, int64_t now_us) {
  const std::string_view published = metadata(image, kPublishedKey);
  int64_t from_us = image.utime;
  std::from_chars(published.data(), published.data() + published.size(), from_us);
  return static_cast<float>(1e-3 * static_cast<double>(now_us - from_us));
}

void set_pose(const TrackResult& r, track_t* track) {
  track->submap_id = r.submap_id;
  track->submap_revision = r.submap_revision;
  track->reference_keyframe = r.reference_keyframe;
  track->cam_from_keyframe = to_wire(r.cam_from_keyframe);
  track->cam_from_submap = to_wire(r.cam_from_submap);
  put_sigmas(r.sigmas, track);
  track->is_keyframe = r.is_keyframe;
  track->keypoints = r.keypoints;
  track->inliers = r.inliers;
}

}  // namespace

void TrackPublisher::begin_session(int64_t session, int64_t stream) {
  session_ = session;
  stream_ = stream;
  sequence_ = 0;
  without_pose_.clear();
  with_pose_.clear();
}

void TrackPublisher::remember(const track_t& track, Told* told) {
  (*told)[track.utime] = track;
  while (told->size() > kMostRetoldFrames) told->erase(told->begin());
}

void TrackPublisher::publish(const image_t& image, const TrackResult& r, double cpu_ms) {
  track_t track;
  track.utime = r.utime_us;
  track.session = session_;
  track.stream = stream_;
  track.sequence = sequence_++;
  track.state = to_wire(r.state);
  set_pose(r, &track);
  track.processing_ms = static_cast<float>(cpu_ms);
  track.latency_ms = latency_ms(image, bus_.now_us());
  bus_.publish(channels::kTrack, track);
  if (r.submap_id == kNoSubmap) return remember(track, &without_pose_);
  without_pose_.clear();
  remember(track, &with_pose_);
  bus_.publish(channels::kCameraToSubmap, to_wire(r.utime_us, r.cam_from_submap.inverse()));
}

void TrackPublisher::publish_posed_afterwards(const std::vector<TrackResult>& frames) {
  for (const TrackResult& r : frames) {
    const auto told = without_pose_.find(r.utime_us);
    if (told == without_pose_.end()) continue;
    track_t track = told->second;  // keeps sequence, state and times
    set_pose(r, &track);
    bus_.publish(channels::kTrack, track);
    remember(track, &with_pose_);
  }
}

void TrackPublisher::publish_withdrawn(const std::vector<int64_t>& utimes_us) {
  for (const int64_t utime_us : utimes_us) {
    const auto told = with_pose_.find(utime_us);
    if (told == with_pose_.end()) continue;
    track_t track = told->second;  // keeps sequence and times
    track.state = track_t::RECENTLY_LOST;
    set_pose({}, &track);
    track.keypoints = told->second.keypoints;
    bus_.publish(channels::kTrack, track);
    with_pose_.erase(told);
  }
}

}  // namespace rumi::front_tracker
