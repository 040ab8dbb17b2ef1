// SPDX-License-Identifier: BSD-3-Clause
// Begins a submap: watches frames until two of them, with what lies between, allow a structure that can be trusted.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "front_tracker/frame.h"
#include "front_tracker/options.h"

namespace rumi {

// A first structure, in the frame of its first view, scaled to a median depth of 1.
struct InitialMap {
  struct View {
    size_t frame = 0;  // index into `frames`
    SE3 cam_from_submap;
    bool keyframe = false;
  };
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<size_t, int>> observations;  // index into `views` (keyframes only), keypoint
  };
  std::vector<Frame> frames;  // all that were buffered, in time order; those without a view have no pose yet
  std::vector<View> views;
  std::vector<Point> points;
};

class Initializer {
 public:
  Initializer(const Camera& camera, const InitializerOptions& options, const std::vector<double>& octave_scales);

  void clear();
  // Keeps the frame for later without trying.
  void buffer(Frame frame);
  // Buffers the frame and tries to begin with it.
  std::optional<InitialMap> add(Frame frame);
  // Why the last try failed, for the log.
  const std::string& refusal() const { return refusal_; }

 private:
  struct Structure;
  void trim();
  std::vector<std::pair<int, int>> match_with_reference(const Frame& frame);
  std::vector<Structure> reconstruct(const std::vector<std::pair<int, int>>& matches);
  void add_views_between(Structure* structure) const;
  // False, and refusal_ set, if the structure does not hold; else its error is known.
  bool adjust(Structure* structure);
  InitialMap finish(Structure structure);

  Camera camera_;
  InitializerOptions options_;
  std::vector<double> scales_;
  std::deque<Frame> frames_;
  size_t reference_ = 0;  // index into frames_
  std::string refusal_;
};

}  // namespace rumi
