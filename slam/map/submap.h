// SPDX-License-Identifier: BSD-3-Clause
// A submap: keyframes, landmarks and the frames whose poses hang on the keyframes. Plain data with the few operations
// that keep it consistent; shared by front_tracker (which builds it), map_server (which stores and joins it) and
// others.
//
// Revisions: a change stamps the changed element with the submap's revision, which the first change after an update was
// made raises, so that what changed since any earlier revision can be sent (see bus/wire/submap_update.h).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "slam/features/features.h"
#include "slam/features/pyramid.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"
#include "slam/map/id_map.h"
#include "slam/map/image_id.h"
#include "slam/map/pose_sigmas.h"
#include "slam/map/removals.h"

namespace rumi {

inline constexpr int kNoSubmap = 0;  // submap ids count up from 1 (front) and down from -1 (back)

// Keyframes are counted up from 0: vectors are indexed by their ids.
inline constexpr int kMaxKeyframeId = (1 << 24) - 1;

struct Keyframe {
  int id = kNone;
  int64_t utime_us = 0;
  SE3 cam_from_submap;
  std::shared_ptr<const Features> features;
  std::vector<int> landmark_ids;  // per keypoint, kNone where it observes nothing
  int64_t revision = 0;           // of the submap when this keyframe last changed
  int64_t created_revision = 0;
};

struct Observation {
  int keyframe_id = kNone;
  int keypoint_index = kNone;
};

struct Landmark {
  int id = kNone;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Descriptor descriptor{};
  std::vector<Observation> observations;  // at most one per keyframe, in order of keyframe id
  int64_t revision = 0;

  // Derived from the observations by update_landmark_view (slam/map/landmark_view.h); never on the wire.
  bool is_described = false;                                 // the descriptor is that of these observations
  Eigen::Vector3d view_direction = Eigen::Vector3d::Zero();  // mean of the unit vectors from the cameras to it
  int visible = 0, found = 0;  // frames in which it should have been seen, and was; kept by whoever tracks with it
  // Inverse covariance of the position, the cameras being where they are and a keypoint's noise a pixel at octave 0.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  double log_scale_variance = 0;  // of the submap's unit there, against its beginning; kept by whoever tracks with it
  double octave0_distance =
      0;  // from where it would be a keypoint of octave 0: octave = log_scale(octave0_distance / d)
};

// cam_from_submap = cam_from_keyframe * keyframe(reference_keyframe).cam_from_submap
struct FramePose {
  int64_t utime_us = 0;
  int reference_keyframe = kNone;
  SE3 cam_from_keyframe;
  int64_t revision = 0;
  PoseSigmas sigmas = {};  // when the frame got its pose
};

struct SubmapKey {
  int64_t session = 0;     // names the run of front_tracker that made it
  int32_t id = kNoSubmap;  // front: 1, 2, 3, ...; back: -1, -2, ...
  auto operator<=>(const SubmapKey&) const = default;
};

enum class SubmapKind : int8_t { kFront = 0, kBack = 1 };

class Submap {
 public:
  SubmapKey key;
  SubmapKind kind = SubmapKind::kFront;
  Camera camera;
  Pyramid pyramid;     // of the keyframes' keypoints
  int64_t stream = 0;  // of its images
  bool closed = false;
  int64_t revision = 0;

  std::map<int, Keyframe> keyframes;    // by id
  IdMap<Landmark> landmarks;            // by id
  std::map<int64_t, FramePose> frames;  // by utime_us, of the stream; keyframes have an entry too
  Removals removed_keyframes, removed_landmarks;

  Keyframe* keyframe(int id);
  const Keyframe* keyframe(int id) const;
  ImageId image(const Keyframe& keyframe) const { return {keyframe.utime_us, stream}; }
  Landmark* landmark(int id) { return landmarks.get(id); }
  const Landmark* landmark(int id) const { return landmarks.get(id); }

  // Both directions of an observation; replaces whatever the keypoint observed before. False, and nothing changed, if
  // an id or index does not exist or the landmark is already observed in that keyframe.
  bool add_observation(int landmark_id, int keyframe_id, int keypoint_index);
  void remove_observation(int landmark_id, int keyframe_id);
  void remove_landmark(int id);
  // Frames that hang on the keyframe move to `heir` (which must exist), their poses unchanged.
  void remove_keyframe(int id, int heir);

  // Every observation of `from` passes to `into` unless the keyframe already observes `into`; `from` is removed.
  void fuse_landmarks(int into, int from);

  // cam_from_submap of a frame or nothing when it has no pose here.
  const FramePose* frame(int64_t utime_us) const;
  // Throws std::logic_error if the frame hangs on a keyframe that does not exist.
  SE3 cam_from_submap(const FramePose& frame) const;

  // Keyframes that share landmarks with this one: id -> number shared, strongest first (ties by id).
  std::vector<std::pair<int, int>> covisible_keyframes(int keyframe_id) const;

  // The revision that a change belongs to.
  int64_t stamp() { return revision = std::max(revision, handed_out_ + 1); }
  void touch(Keyframe& keyframe) { keyframe.revision = stamp(); }
  void touch(Landmark& landmark) { landmark.revision = stamp(); }
  // Others know this revision now: what changes from here on is of a newer one.
  void hand_out() { handed_out_ = revision; }

 private:
  int64_t handed_out_ = 0;
};

}  // namespace rumi
