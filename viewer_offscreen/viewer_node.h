// SPDX-License-Identifier: BSD-3-Clause
// Follows the map by its messages and draws it.
#pragma once

#include <optional>
#include <string>

#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/wire/map_overview.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/live/frame_notes.h"
#include "viewer_offscreen/live/submap_copies.h"
#include "viewer_offscreen/options.h"
#include "viewer_offscreen/picture/camera_images.h"
#include "viewer_offscreen/picture/picture_series.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi::viewer_offscreen {

class ViewerNode : public Node {
 public:
  // Throws std::runtime_error if options contradict each other.
  ViewerNode(Bus& bus, const ViewerOptions& options);

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  // Fetches what is still missing, for at most 3 s, and draws a last picture.
  void finish() override;
  std::string waits_for() const override { return phase_ == Phase::kFinished ? "" : "the last picture is not drawn"; }

  int64_t pictures() const { return pictures_; }

 private:
  enum class Phase { kRunning, kFinishing, kFinished };
  void on_track(const track_t& track);
  void on_map_status(const map_status_t& status);
  void request_missing(int64_t now_us);
  MapPicture picture() const;
  Result<cv::Mat> draw_picture();
  void draw();
  Result<> write(const cv::Mat& image);
  void report(const std::string& trouble);

  Bus& bus_;
  NewestSender sessions_{"RUMI_TRACK"};
  ViewerOptions options_;
  std::string name_;
  SubmapCopies copies_;
  std::optional<PictureSeries> series_;
  std::optional<Renderer> renderer_;  // if pictures are drawn often
  CameraImages images_;
  MapOverview since_finish_;  // what map_server has reported since finish()
  FrameNotes frames_;
  std::optional<track_t> live_;
  bool changed_ = false;
  Phase phase_ = Phase::kRunning;
  int64_t finish_us_ = 0, last_draw_us_ = 0, last_utime_us_ = 0;
  int64_t pictures_ = 0;
  double draw_ms_ = 0;
  std::string trouble_;
};

}  // namespace rumi::viewer_offscreen
