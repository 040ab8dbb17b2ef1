// SPDX-License-Identifier: BSD-3-Clause
// Follows the map by its messages and draws it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/wire/map_overview.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "slam/map/submap.h"
#include "viewer_offscreen/options.h"
#include "viewer_offscreen/picture/camera_images.h"
#include "viewer_offscreen/picture/picture_series.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi::viewer_offscreen {

class ViewerNode : public Node {
 public:
  // Throws std::runtime_error for options that contradict each other.
  ViewerNode(Bus& bus, const ViewerOptions& options);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  // Fetches what is still missing, for 3 s at most, and draws a last picture.
  void finish() override;
  std::string waits_for() const override { return phase_ == Phase::kFinished ? "" : "the last picture is not drawn"; }

  int64_t pictures() const { return pictures_; }

 private:
  enum class Phase { kRunning, kFinishing, kFinished };
  struct Copy {
    Submap submap;
    int64_t placement_revision = 0;  // of the submap as we have it; 0: in its own gauge
    submap_summary_t summary;        // what map_server said of it last
    int32_t request_id = 0;          // under way, 0: none
    int64_t asked_us = 0, asked_placement_revision = 0;
    // Where nobody has placed it, what is in its own gauge is in the map's, and only what is new has to travel.
    int64_t wanted_placement_revision() const { return summary.in_map ? summary.placement_revision : 0; }
    bool up_to_date() const {
      return submap.revision >= summary.revision && placement_revision == wanted_placement_revision();
    }
    // In the map, and we have it in the map's gauge, if perhaps not where it lies now.
    bool can_be_shown_in_map() const {
      return summary.in_map && (placement_revision == 0) == (summary.placement_revision == 0);
    }
  };

  void on_track(const track_t& track);
  void note_frame(const track_t& track);
  void on_map_status(const map_status_t& status);
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  bool is_time_to_ask(const Copy& copy, int64_t now_us) const;
  void request_missing(int64_t now_us);
  bool complete() const;
  MapPicture picture() const;
  void draw();
  std::string write(const cv::Mat& image);
  void report(const std::string& trouble);

  Bus& bus_;
  NewestSender sessions_{"RUMI_TRACK"}, map_states_{"RUMI_MAP_STATUS", kLateUs};
  ViewerOptions options_;
  std::string name_;
  ChunkReceiver receiver_;
  std::optional<Renderer> renderer_;
  std::optional<PictureSeries> series_;
  CameraImages images_;
  MapOverview map_;
  MapOverview since_finish_;  // what was told since then
  std::map<SubmapKey, Copy> copies_;
  std::vector<FrameNote> frames_;  // all heard of, by time
  std::vector<MapPicture::Link> links_;
  std::optional<track_t> live_;
  bool changed_ = false;
  Phase phase_ = Phase::kRunning;
  int64_t finish_us_ = 0, last_draw_us_ = 0, last_utime_us_ = 0;
  int32_t last_request_ = 0;
  int64_t pictures_ = 0, rejected_ = 0;
  double draw_ms_ = 0;
  std::string trouble_;
};

}  // namespace rumi::viewer_offscreen
