// SPDX-License-Identifier: BSD-3-Clause
// The atlas holds all submaps, what became of every frame, and which submaps form the map that is served. It knows no
// LCM and no files.
//
// The served map is made of the submaps that place_map() named last. Until somebody has placed submaps, the map is the
// front submap with most frames (or the back submap with most, if there is no front submap), in its own unit and frame
// of reference. Present sessions (note_present()) come before earlier ones: as long as nothing joins the two, the map
// is made of the present ones, and the map of earlier sessions stays beside it, with its placements.
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

// The record of what front_tracker said of a frame when it saw it. Only the submaps know whether the frame has a pose
// now: poses are added to earlier frames, and corrected, after the fact.
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
  // True for the submaps of the map of earlier sessions that is not served now.
  bool is_beside() const { return !in_map && placement.revision > 0; }
};

// A frame's pose. If several submaps have a pose of the frame, it is the one that counts.
struct LocatedFrame {
  const AtlasSubmap* owner = nullptr;
  const FramePose* frame = nullptr;
  SE3 cam_from_submap() const { return owner->submap.cam_from_submap(*frame); }
  // The owner must be in the map.
  SE3 cam_from_map() const { return owner->placement.cam_from_map(owner->submap, *frame); }
  // In the map's unit if the owner is in the map, else in the submap's.
  PoseSigmas sigmas() const;
};

// "submap 3", "submaps 1, -1 and 2"; "12 submaps" if there are many, or if they are of several sessions. The set must
// not be empty.
std::string describe(const std::set<SubmapKey>& submaps);

class Atlas {
 public:
  // Runs `change` on a submap (a new one if the key is new) and returns its Error. A change that gives an Error must
  // have left the submap as it was. An unknown submap is kept only if the change raised its revision.
  Result<> change_submap(SubmapKey key, const std::function<Result<>(Submap*)>& change);
  // From now on exactly these submaps form the served map, until the next call: however large another one grows, it
  // does not take the map's place. None: back to the largest submap. The revisions of the placements are set here.
  // Returns the placements before, to be freed elsewhere; an Error, and nothing changes, for a submap that is not here.
  Result<std::vector<Placement>> place_map(PlacedMap map);
  // All there are, instead of those before. An Error, and nothing changes, for a submap that is not here or a number
  // that is not finite.
  Result<> set_links(std::vector<Link> links);
  // The Error that place_map() or set_links() would return.
  Result<> check(const PlacedMap& map, const std::vector<Link>& links) const;
  // Takes what a RUMI_TRACK message says. True if that is news.
  bool record_frame(ImageId image, const FrameRecord& record);
  // Takes the mask of a stream, which the caller has checked with check(). The oldest mask is dropped when there are
  // too many streams. Returns true if the mask is news: not if a newer one is known.
  bool record_mask(int64_t stream, StillMask mask);
  // Notes a session that goes on now, in contrast to those of earlier runs.
  void note_present(int64_t session) { present_.insert(session); }
  const std::set<int64_t>& present() const { return present_; }
  // Serves the largest submap of the present sessions if there is one and none of them is in the map. Returns whether
  // the map is another one now.
  bool serve_present();
  // Serves the larger one of the map and the map beside it. Call it before any session is present.
  void serve_larger();
  // For MapStore::load(): these put back what was saved, as it was.
  void restore_submap(AtlasSubmap submap);
  void restore_placement(SubmapKey key, Placement placement) { submaps_.at(key).placement = std::move(placement); }
  void restore_revision(int64_t revision) { revision_ = revision; }

  const std::map<SubmapKey, AtlasSubmap>& submaps() const { return submaps_; }
  std::set<SubmapKey> in_map() const;
  const std::vector<Link>& links() const { return links_; }
  const AtlasSubmap* find(SubmapKey key) const;
  const std::map<ImageId, FrameRecord>& frames() const { return frames_; }  // all ever heard of
  const std::map<int64_t, StillMask>& masks() const { return masks_; }      // the newest of each stream
  int64_t revision() const { return revision_; }  // rises whenever anything of the served map changed
  int64_t frames_in_map() const;

  // Frames of the present sessions and of the earlier ones.
  struct FrameCounts {
    int64_t present = 0, earlier = 0;
    int64_t present_in_map = 0, earlier_in_map = 0;
    bool is_joined = false;  // the map has submaps of both
  };
  FrameCounts count_frames() const;

  // True if the map has the landmark as a point of its own, because it is fused into no landmark that still exists.
  bool stands_for_itself(const AtlasSubmap& owner, int landmark_id) const;

  // Chooses the pose of an image that counts. Poses in the served map come first, and among them those whose keyframe
  // was placed itself; then the pose in the submap in which the frame was tracked; then front before back.
  std::optional<LocatedFrame> locate(ImageId image) const;
  // map_from_cam of every frame with a pose in the served map, in the map's unit.
  std::map<ImageId, SE3> map_trajectory() const;

 private:
  // The number of a submap's frames that no submap counted before it has, and the revisions that it was counted of.
  struct Counted {
    std::vector<std::pair<SubmapKey, int64_t>> of;  // the submap, and the others that may share images with it
    int64_t frames = 0;
  };

  void note_frames(const Submap& submap, int64_t after_revision);
  Result<> check_here(const PlacedMap& map) const;
  Result<> check_links(const std::vector<Link>& links) const;
  std::set<SubmapKey> find_same(const PlacedMap& map) const;
  bool is_placed() const;  // whether place_map() has said what the map is made of
  bool choose_map();       // returns whether the served map is now made of other submaps than before
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
