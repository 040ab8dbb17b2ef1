// SPDX-License-Identifier: BSD-3-Clause
// Imitates a running system. Unless other submaps are given, it has two front submaps and the back submap that joins
// them.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"
#include "tests/viewer_offscreen/test_map.h"

namespace rumi::tool {

class FalseSystem {
 public:
  static constexpr int64_t kSession = 1;

  explicit FalseSystem(Bus& bus, std::map<int, Submap> submaps = three_submaps())
      : bus_(bus), sender_(bus, channels::kMapChunk, channels::kMapAck, "server"), submaps_(std::move(submaps)) {
    bus.subscribe<map_request_t>(channels::kMapRequest, {}, [this](const map_request_t& r) { on_request(r); });
  }

  static std::map<int, Submap> three_submaps() {
    using viewer_offscreen::make_test_submap;
    using viewer_offscreen::test_circle;
    return {{1, make_test_submap(1, 0, 5, test_circle, 3000)},
            {-1, make_test_submap(-1, 4, 8, test_circle, 1500)},
            {2, make_test_submap(2, 7, 12, test_circle, 2000)}};
  }

  Submap& submap(int id) { return submaps_.at(id); }
  std::vector<map_request_t> take_requests() { return std::exchange(requests_, {}); }

  // Publishes a status with all submaps, as they are now.
  void publish_map() {
    map_status_t status{};
    status.utime = bus_.now_us();
    status.map_revision = ++revision_;
    for (const auto& [id, submap] : submaps_) {
      submap_summary_t summary{};
      summary.session = kSession;
      summary.submap_id = id;
      summary.kind = id < 0 ? submap_update_t::BACK : submap_update_t::FRONT;
      summary.in_map = true;
      summary.closed = id != 2;
      summary.revision = submap.revision;
      summary.map_from_submap = to_wire(Sim3());
      status.submaps.push_back(summary);
      ++(id < 0 ? status.back_submaps : status.front_submaps);
      status.keyframes += static_cast<int64_t>(submap.keyframes.size());
      status.landmarks += static_cast<int64_t>(submap.landmarks.size());
    }
    status.nsubmaps = status.submaps_in_map = static_cast<int32_t>(submaps_.size());
    status.frames = status.frames_in_map = 360;
    for (const auto& [a, b] : {std::pair(1, -1), std::pair(2, -1)}) {
      link_t link{};
      link.session_a = link.session_b = kSession;
      link.submap_a = a;
      link.submap_b = b;
      link.kind = link_t::SAME_IMAGES;
      link.accepted = true;
      status.links.push_back(link);
    }
    status.nlinks = status.links_in_all = status.links_accepted = 2;
    bus_.publish(channels::kMapStatus, status);
  }
  // Publishes 12 s of tracking at 30 Hz; it is lost from 5 to 7 s.
  void publish_tracks() {
    for (int i = 0; i < 360; ++i) publish_track(i, i < 150 ? 1 : i < 210 ? kNoSubmap : 2);
  }
  // Publishes one frame of a sequence at 30 Hz. In kNoSubmap, tracking is lost.
  void publish_track(int sequence, int submap) {
    track_t track{};
    track.utime = 1'000'000 + int64_t{sequence} * 33'333;
    track.session = kSession;
    track.sequence = sequence;
    track.submap_id = submap;
    track.state = submap == kNoSubmap ? track_t::LOST : track_t::TRACKING;
    if (submap != kNoSubmap) {
      const Submap& in = submaps_.at(submap);
      track.cam_from_submap = to_wire(in.cam_from_submap(in.frames.at(track.utime)));
    }
    bus_.publish(channels::kTrack, track);
  }
  // Publishes a lost frame, which follows the frames of publish_tracks() and all earlier lost frames.
  void publish_loss() { publish_track(lost_frames_++, kNoSubmap); }
  void publish_image(cv::Size size = {1280, 720}) {
    cv::Mat image(size, CV_8UC3, cv::Scalar(60, 120, 40));
    image.colRange(0, size.width / 2) = cv::Scalar(200, 180, 160);
    bus_.publish(channels::kCamera, make_jpeg_image(bus_.now_us(), image));
  }
  void publish_statuses() {
    for (const char* name : {"camera_driver", "front_tracker", "map_server", "ruminator", "viewer_offscreen"}) {
      process_status_t status{};
      status.utime = bus_.now_us();
      status.process = name;
      status.pid = 7;
      status.host = "kitchen";
      status.state = process_status_t::RUNNING;
      status.detail = std::string("all is well with <b>") + name + "</b>";
      status.started_utime = 19'000'000;
      status.cpu_s = 0.4e-6 * static_cast<double>(bus_.now_us());
      status.rss_bytes = 60'000'000;
      bus_.publish(channels::kStatus, status);
    }
  }
  void publish_window() {
    window_t window{};
    window.utime = bus_.now_us();
    window.session = kSession;
    window.window_id = 1;
    window.state = window_t::PUBLISHED;
    bus_.publish(channels::kWindow, window);
  }
  // Adds a landmark to a submap.
  void grow(int id) {
    Submap& submap = submaps_.at(id);
    ++submap.revision;
    Landmark landmark;
    landmark.id = 1'000'000 + static_cast<int>(submap.revision);
    landmark.position = {0.5, 0.5, 0.5};
    landmark.revision = submap.revision;
    submap.landmarks[landmark.id] = landmark;
  }
  void tick() { sender_.tick(bus_.now_us()); }

 private:
  void on_request(const map_request_t& request) {
    requests_.push_back(request);
    const auto asked = submaps_.find(request.submap_id);
    if (asked == submaps_.end()) return;
    sender_.send(request.requester, chunk_t::SUBMAP_UPDATE, request.request_id,
                 encode_message(make_submap_update(asked->second, request.base_revision)),
                 [](const TransferResult&) {});
  }

  Bus& bus_;
  ChunkSender sender_;
  std::map<int, Submap> submaps_;
  std::vector<map_request_t> requests_;
  int64_t revision_ = 0;
  int lost_frames_ = 360;
};

}  // namespace rumi::tool
