// SPDX-License-Identifier: BSD-3-Clause
// The layout of a picture, in pixels of 1280 x 720.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "viewer_offscreen/picture/map_view.h"

namespace rumi::viewer_offscreen {

inline constexpr int kPictureWidth = 1280, kPictureHeight = 720;

struct Layout {
  struct View {
    ViewKind kind;
    cv::Rect panel;
    bool is_main;
  };
  std::vector<View> views;
  cv::Rect camera;  // room for the camera's image; empty if none is shown
  cv::Rect legend, strip;
};

// Returns the layout of all four views. If there is no image of the camera, the follow view takes its room.
inline Layout layout_all(bool with_camera) {
  Layout l;
  const Layout::View oblique{ViewKind::kOblique, {16, 52, 640, 566}, true};
  if (with_camera) {
    l.views = {oblique,
               {ViewKind::kTop, {666, 52, 290, 232}, false},
               {ViewKind::kSide, {666, 294, 290, 120}, false},
               {ViewKind::kFollow, {666, 424, 290, 194}, false}};
    l.camera = {966, 52, 298, 224};
    l.legend = {968, 304, 296, 314};
  } else {
    l.views = {oblique,
               {ViewKind::kTop, {666, 52, 290, 380}, false},
               {ViewKind::kSide, {666, 442, 290, 176}, false},
               {ViewKind::kFollow, {966, 52, 298, 224}, false}};
    l.legend = {968, 290, 296, 328};
  }
  l.strip = {16, 632, 1248, 80};
  return l;
}

// Returns the layout of one large view.
inline Layout layout_one(ViewKind kind, bool with_camera) {
  Layout l = layout_all(with_camera);
  l.views = {{kind, {16, 52, 940, 566}, true}};
  if (!with_camera) l.legend = {968, 56, 296, 562};
  return l;
}

}  // namespace rumi::viewer_offscreen
