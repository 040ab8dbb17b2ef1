// SPDX-License-Identifier: BSD-3-Clause
// A submap: keyframes, landmarks and the frames whose poses refer to the keyframes. front_tracker and ruminator make
// submaps; map_server stores and joins them.
//
// Revisions: a submap's maker changes it through its methods. A method stamps each element that it changes with the
// submap's revision. The first change after hand_out() raises the revision, so that everything that changed since an
// earlier revision can be sent (see bus/wire/submap_update.h). The maps are public for readers, and for those who write
// a copy with the revisions that its maker gave (apply_submap_update, MapStore).
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
#include "slam/map/frame_table.h"
#include "slam/map/id_map.h"
#include "slam/map/image_id.h"
#include "slam/map/removals.h"

namespace rumi {

inline constexpr int kNoSubmap = 0;  // submap ids count up from 1 (front) and down from -1 (back)

// The largest id of a keyframe. Ids count up from 0, and vectors are indexed by them: a huge one would exhaust memory.
inline constexpr int kMaxKeyframeId = (1 << 24) - 1;

struct Keyframe {
  int id = kNone;
  int64_t utime_us = 0;
  SE3 cam_from_submap;
  std::shared_ptr<const Features> features;
  std::vector<int> landmark_ids;  // by keypoint; kNone if it observes no landmark
  int64_t revision = 0;           // the submap's revision when this keyframe last changed
  int64_t created_revision = 0;   // the submap's revision when it was added, or its features last changed
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

  // Derived from the observations by update_landmark_view (slam/map/landmark_view.h); never transmitted.
  bool is_described = false;                                 // true: the descriptor was chosen, and is kept
  Eigen::Vector3d view_direction = Eigen::Vector3d::Zero();  // mean direction from the cameras to the landmark, a unit
                                                             // vector
  // The number of frames that should have seen the landmark, and of those that did. Only the tracker that uses the
  // landmark keeps them.
  int visible = 0, found = 0;
  // The inverse covariance of the position, if the cameras' poses are right and the noise of a keypoint at octave 0 is
  // one pixel.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  // The variance of the log of the submap's unit at the landmark, relative to its unit at the beginning. Only the
  // tracker keeps it.
  double log_scale_variance = 0;
  // The distance at which the landmark would be a keypoint of octave 0. At distance d its octave is
  // log(octave0_distance / d) / log(scale_factor).
  double octave0_distance = 0;
};

struct SubmapKey {
  int64_t session = 0;     // identifies the session of front_tracker that the submap belongs to
  int32_t id = kNoSubmap;  // front: 1, 2, 3, ...; back: -1, -2, ...
  auto operator<=>(const SubmapKey&) const = default;
};

enum class SubmapKind : int8_t { kFront = 0, kBack = 1 };

class Submap {
 public:
  SubmapKey key;
  SubmapKind kind = SubmapKind::kFront;
  Camera camera;
  Pyramid pyramid;     // pyramid in which the keyframes' keypoints were found
  int64_t stream = 0;  // source of the images (ImageId::stream)
  bool closed = false;
  int64_t revision = 0;

  std::map<int, Keyframe> keyframes;  // by id
  IdMap<Landmark> landmarks;          // by id
  FrameTable frames;                  // keyframes have an entry too
  Removals removed_keyframes, removed_landmarks;

  Keyframe* keyframe(int id);
  const Keyframe* keyframe(int id) const;
  ImageId image(const Keyframe& keyframe) const { return {keyframe.utime_us, stream}; }
  Landmark* landmark(int id) { return landmarks.get(id); }
  const Landmark* landmark(int id) const { return landmarks.get(id); }

  // Turns this copy of another submap into the beginning of the front submap `key`: it is open, and all its elements
  // count as new.
  void begin_front_submap(SubmapKey key);
  // Marks the submap as complete. Does nothing if it is closed already.
  void close();

  // Adds a keyframe, which must have a new id, features and a pose. It does not observe any landmark yet.
  Keyframe& add_keyframe(Keyframe keyframe);
  // Adds a landmark with a new id. No keyframe observes it yet.
  Landmark& add_landmark(int id, const Eigen::Vector3d& position);
  // Adds the pose of a frame, or replaces it. Its `revision` is set here.
  void set_frame(FramePose frame);

  // move_keyframe() and move_landmark() do nothing if the id does not exist.
  void move_keyframe(int id, const SE3& cam_from_submap);
  void move_landmark(int id, const Eigen::Vector3d& position);
  // Says that the keyframe's features have changed, so that the next update sends them again. The keyframe must exist.
  void renew_features(int keyframe_id);

  // Adds both directions of an observation, and replaces what the keypoint observed before. Returns false, and changes
  // nothing, if an id or index does not exist or the keyframe observes the landmark already.
  bool add_observation(int landmark_id, int keyframe_id, int keypoint_index);
  void remove_observation(int landmark_id, int keyframe_id);
  void remove_landmark(int id);
  // Lets the frames that refer to the keyframe refer to `heir`, with unchanged poses, and removes it. Does nothing if
  // `heir` does not exist.
  void remove_keyframe(int id, int heir);
  // Removes the frames from `utime_us` on. An update cannot name removed frames, so copies are sent the whole submap
  // next.
  void remove_frames_from(int64_t utime_us);

  // Gives each observation of `from` to `into`, unless its keyframe observes `into` already, and removes `from`. Does
  // nothing if one of the two does not exist.
  void fuse_landmarks(int into, int from);

  // Returns nullptr if the frame has no pose in this submap.
  const FramePose* frame(int64_t utime_us) const { return frames.get(utime_us); }
  // Throws std::logic_error if the frame's reference keyframe does not exist.
  SE3 cam_from_submap(const FramePose& frame) const;

  // Returns the keyframes that share landmarks with this one, as (id, number shared), strongest first (ties by id).
  std::vector<std::pair<int, int>> covisible_keyframes(int keyframe_id) const;

  // To be called when an update has been made: later changes get a newer revision.
  void hand_out() { handed_out_ = revision; }

 private:
  // Returns the revision for a change that is made now.
  int64_t stamp() { return revision = std::max(revision, handed_out_ + 1); }
  void touch(Keyframe& keyframe) { keyframe.revision = stamp(); }
  void touch(Landmark& landmark) { landmark.revision = stamp(); }

  int64_t handed_out_ = 0;
};

}  // namespace rumi
