// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewer_offscreen/canvas/plot_canvas.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Draws the timeline in two lanes: how each frame was tracked when it came, and where it is in the map now. A tracked
// frame is a bar of full height in its submap's colour. Other frames are lower bars; the lowest ones were not
// initialized, or their state is unknown.
class TimelineStrip {
 public:
  TimelineStrip(const Scene& scene, const cv::Rect& area);
  void draw_shapes(PlotCanvas& canvas) const;
  void draw_words(cv::Mat& large) const;

 private:
  double x_of(int64_t utime_us) const;
  double seconds() const;
  void draw_lane(PlotCanvas& canvas, double top, const std::vector<TimelineSpan>& spans, bool is_map) const;
  void draw_span(PlotCanvas& canvas, double top, const TimelineSpan& span, bool is_map) const;
  const Scene& scene_;
  cv::Rect area_;
};

// Returns "12.3 s", "4:05" or "1:02:03".
std::string format_time(double seconds);
// Returns a round time step in seconds, so that at most `most` steps cover the duration.
double round_time_step(double duration_s, int most);

}  // namespace rumi::viewer_offscreen
