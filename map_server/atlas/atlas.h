// SPDX-License-Identifier: BSD-3-Clause
// The atlas holds all submaps, the tracking result of every frame, and which submaps form the served map. It knows
// nothing of LCM or files.
//
// The served map consists of the submaps in the last place_map(). Before the first place_map(), it is the front submap
// with most frames (or the back submap with most frames, if there is no front submap), in its own unit and frame of
// reference. Present sessions (note_present()) come before earlier ones: as long as nothing joins the two, the map
// consists of submaps of the present sessions, and the map of earlier sessions stays beside it, with its placements.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "map_server/atlas/placed_map.h"
#include "map_server/atlas/placement.h"
#include "map_server/atlas/still_mask.h"
#include "map_server/links/link.h"
#include "slam/geometry/transform.h"
#include "slam/map/submap.h"
#include "slam/map/tracking_state.h"

namespace rumi::map_server {

// Records what front_tracker said about a frame when it tracked it. Whether the frame has a pose now is known by the
// submaps only, because poses are added and corrected later.
struct FrameRecord {
  int64_t session = 0;
  TrackingState state = TrackingState::kUnknown;
  int32_t submap_id = kNoSubmap;  // the submap in which it was tracked
  bool operator==(const FrameRecord&) const = default;
};

struct AtlasSubmap {
  Submap submap;
  bool in_map = false;  // part of the served map
  Placement placement;  // in the served map, or in the map beside it
  // True if the submap belongs to the map of earlier sessions that is not served now.
  bool is_beside() const { return !in_map && placement.revision > 0; }
};

// The pose that counts for a frame, if several submaps have one.
struct LocatedFrame {
  const AtlasSubmap* owner = nullptr;
  const FramePose* frame = nullptr;
  SE3 cam_from_submap() const { return owner->submap.cam_from_submap(*frame); }
  // True if the image is itself a keyframe, which the adjustment of the map moves.
  bool is_keyframe() const;
  // The owner must be in the map.
  SE3 cam_from_map() const { return owner->placement.cam_from_map(owner->submap, *frame); }
  // Returns the deviations of the pose, in the map's unit if the owner is in the map, otherwise in the submap's.
  PoseSigmas sigmas() const;
};

// Returns "submap 3", "submaps 1, -1 and 2", or "12 submaps" if there are many or they are of several sessions. The set
// must not be empty.
std::string describe(const std::set<SubmapKey>& submaps);

class Atlas {
 public:
  // Runs `change` on a submap (a new one if the key is new) and returns its Error. If it returns an Error, `change`
  // must leave the submap unchanged. A new submap is kept only if the change raised its revision.
  Result<> change_submap(SubmapKey key, const std::function<Result<>(Submap*)>& change);
  // Makes exactly these submaps the served map until the next call, even if another submap grows larger than the map.
  // An empty map restores the default, the largest submap. Sets the revisions of the placements. Returns the previous
  // placements, which the caller may free in another thread. An Error, and no change, if a submap is not in the atlas.
  Result<std::vector<Placement>> place_map(PlacedMap map);
  // Replaces all links. An Error, and no change, if a submap is not in the atlas or a number is invalid.
  Result<> set_links(std::vector<Link> links);
  // Returns the Error that place_map() or set_links() would return.
  Result<> check(const PlacedMap& map, const std::vector<Link>& links) const;
  // Records what a RUMI_TRACK message says about a frame. Returns true if that is new.
  bool record_frame(ImageId image, const FrameRecord& record);
  // Records the mask of a stream, which the caller has checked with check(). If there are more than 64 streams, drops
  // the oldest mask. Returns false if the atlas has the same mask, or a newer one, already.
  bool record_mask(int64_t stream, StillMask mask);
  // Notes that the session goes on now, in contrast to sessions of earlier runs.
  void note_present(int64_t session) { present_.insert(session); }
  const std::set<int64_t>& present() const { return present_; }
  // If no submap of the present sessions is in the map and there is one, serves the largest one. Returns true if the
  // served map has changed.
  bool serve_present();
  // Serves the larger one of the map and the map beside it. Call it before any session is present.
  void serve_larger();
  // These restore what was saved, unchanged, for MapStore::load().
  void restore_submap(AtlasSubmap submap);
  void restore_placement(SubmapKey key, Placement placement) { submaps_.at(key).placement = std::move(placement); }
  void restore_revision(int64_t revision) { revision_ = revision; }

  const std::map<SubmapKey, AtlasSubmap>& submaps() const { return submaps_; }
  std::set<SubmapKey> in_map() const;
  const std::vector<Link>& links() const { return links_; }
  const AtlasSubmap* find(SubmapKey key) const;
  const std::map<ImageId, FrameRecord>& frames() const { return frames_; }  // all frames of which anything was received
  const std::map<int64_t, StillMask>& masks() const { return masks_; }      // the newest mask of each stream
  int64_t revision() const { return revision_; }  // rises whenever anything of the served map changed
  int64_t frames_in_map() const;

  // Frames of the present sessions and of the earlier ones.
  struct FrameCounts {
    int64_t present = 0, earlier = 0;
    int64_t present_in_map = 0, earlier_in_map = 0;
    bool is_joined = false;  // the map has submaps of both
  };
  FrameCounts count_frames() const;

  // True if the landmark is a point of the map itself: it is not fused into another landmark that the map still has.
  bool stands_for_itself(const AtlasSubmap& owner, int landmark_id) const;

  // Chooses the pose that counts for an image. Poses in the served map come first, and among them those whose own
  // keyframe is placed, and among those the image's own keyframes, which the adjustment has moved, and among those back
  // submaps; then the pose in the submap in which the frame was tracked; then poses in front submaps.
  std::optional<LocatedFrame> locate(ImageId image) const;
  // map_from_cam of every frame with a pose in the served map, in the map's unit.
  std::map<ImageId, SE3> map_trajectory() const;

 private:
  // The number of a submap's frames that no submap counted before it has. It is valid for these revisions of the
  // submaps.
  struct Counted {
    std::vector<std::pair<SubmapKey, int64_t>> of;  // the submap itself, and earlier ones that may share images with it
    int64_t frames = 0;
  };

  void note_frames(const Submap& submap, int64_t after_revision);
  Result<> check_here(const PlacedMap& map) const;
  Result<> check_links(const std::vector<Link>& links) const;
  std::set<SubmapKey> find_same(const PlacedMap& map) const;
  bool is_placed() const;  // whether place_map() has set the map
  bool choose_map();       // returns true if the served map has changed
  bool has_present_in_map() const;
  std::set<SubmapKey> map_beside(const std::set<SubmapKey>& map) const;
  const Counted& count(const AtlasSubmap& owner, const std::vector<const Submap*>& before) const;

  std::map<SubmapKey, AtlasSubmap> submaps_;
  std::map<ImageId, FrameRecord> frames_;
  std::map<int64_t, int64_t> frames_of_;  // number of frames by session
  std::map<int64_t, StillMask> masks_;
  std::vector<Link> links_;
  std::set<int64_t> present_;
  int64_t revision_ = 0;
  mutable std::map<SubmapKey, Counted> counted_;
};

}  // namespace rumi::map_server
