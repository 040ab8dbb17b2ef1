// SPDX-License-Identifier: BSD-3-Clause
// All submaps, what became of every frame, and which submaps form the map that is served. Knows no LCM and no files.
//
// The served map is made of the submaps that place_map() named last. As long as nobody has placed any, the front submap
// with most frames stands for it, or the back submap where there is no front one, in its own unit and frame of
// reference. What is told of present sessions (note_present()) comes before what earlier ones have left: as long as
// nothing joins the two, the present ones are the map, and that of before keeps its places beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "map_server/atlas/placement.h"
#include "map_server/atlas/still_mask.h"
#include "map_server/links/link.h"
#include "slam/geometry/transform.h"
#include "slam/map/submap.h"
#include "slam/map/tracking_state.h"

namespace rumi::map_server {

// What front_tracker said of a frame when it saw it. Whether the frame has a pose now is the submaps' to say: poses are
// added to earlier frames, and corrected, after the fact.
struct FrameRecord {
  int64_t session = 0;
  TrackingState state = TrackingState::kUnknown;
  int32_t submap_id = kNoSubmap;  // that it was tracked in
  bool operator==(const FrameRecord&) const = default;
};

struct AtlasSubmap {
  Submap submap;
  bool in_map = false;  // part of the served map
  Placement placement;  // in the served map, or in the one of earlier sessions that is kept beside it
  bool is_kept() const { return !in_map && placement.revision > 0; }
};

// Where a frame is: the pose that counts, if several submaps have one.
struct LocatedFrame {
  const AtlasSubmap* owner = nullptr;
  const FramePose* frame = nullptr;
  SE3 cam_from_submap() const { return owner->submap.cam_from_submap(*frame); }
  // Meaningful where the owner is in the map.
  SE3 cam_from_map() const { return owner->placement.cam_from_map(owner->submap, *frame); }
  // In the map's unit where the owner is in the map, else in the submap's.
  PoseSigmas sigmas() const;
};

// "submap 3", "submaps 1, -1 and 2"; of many, or of several sessions, how many: "12 submaps". Not of none.
std::string describe(const std::set<SubmapKey>& submaps);

class Atlas {
 public:
  // Runs `change` on a submap (a new one if the key is new). It returns what is wrong, or an empty string; if something
  // is wrong it must have left the submap as it was. An unknown submap is kept only if the change raised its revision.
  std::string change_submap(SubmapKey key, const std::function<std::string(Submap*)>& change);
  // From now on exactly these submaps form the served map, and lie in it like this, until the next call: however large
  // another one grows, it does not take the map's place. None: back to the largest submap. The revisions of the
  // placements are set here. Throws std::invalid_argument, and changes nothing, for a submap that is not here, a
  // landmark fused into one of a submap that is not among these, or a number that is not finite.
  // `unmoved`: submaps that form it too and stay where they are in it.
  void place_map(std::map<SubmapKey, Placement> placements, const std::set<SubmapKey>& unmoved = {});
  // The same at a price that does not grow with the submaps, of placements that hold: check_numbers() was content, and
  // `same` are those that lie where they lay, to the bit. Returns the placements before, to be freed elsewhere.
  std::vector<Placement> swap_map(std::map<SubmapKey, Placement> placements, const std::set<SubmapKey>& unmoved,
                                  const std::set<SubmapKey>& same);
  // All there are, instead of those before. Throws std::invalid_argument, and changes nothing, for a submap that is not
  // here or a number that is not finite.
  void set_links(std::vector<Link> links);
  // Throw what these would throw: of what is not here, and of numbers, which can be asked without an atlas.
  void check_here(const std::map<SubmapKey, Placement>& placements, const std::set<SubmapKey>& unmoved) const;
  static void check_numbers(const std::map<SubmapKey, Placement>& placements, const std::set<SubmapKey>& unmoved);
  void check_links(const std::vector<Link>& links) const;
  // Takes what a RUMI_TRACK message says. True if that is news.
  bool record_frame(ImageId image, const FrameRecord& record);
  // Takes what never moves in the images of a stream, which check() was content with; of too many streams the oldest
  // is forgotten. True if that is news: not if a newer one is known.
  bool record_mask(int64_t stream, StillMask mask);
  // A session that goes on now, not one of an earlier run.
  void note_present(int64_t session) { present_.insert(session); }
  const std::set<int64_t>& present() const { return present_; }
  // Serves the largest submap of the present sessions if there is one, and none of them is in the map. True if it did.
  bool serve_present();
  // Before any session is present: of the map and the one that is kept beside it, the larger one is served.
  void serve_larger();
  // For loading: puts a submap as it was, with its place in the map.
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

  // Of the present sessions and of the earlier ones.
  struct FrameCounts {
    int64_t present = 0, earlier = 0;
    int64_t present_in_map = 0, earlier_in_map = 0;
    bool is_joined = false;  // the map has submaps of both
  };
  FrameCounts count_frames() const;

  // Whether the map has the landmark as a point of its own: it is fused into no other that is still there.
  bool stands_for_itself(const AtlasSubmap& owner, int landmark_id) const;

  // A pose in the served map comes first; in the map, one that hangs on a keyframe which was placed itself, not by its
  // neighbours; then one in the submap that the frame was tracked in, then front before back.
  std::optional<LocatedFrame> locate(ImageId image) const;
  // map_from_cam of every frame with a pose in the served map. Lengths are the map's.
  std::map<ImageId, SE3> map_trajectory() const;

 private:
  // Frames of a submap of the map that no earlier one has, as it was counted last, and of what.
  struct Counted {
    std::vector<std::pair<SubmapKey, int64_t>> of;  // the submap and those beside it, with their revisions
    int64_t frames = 0;
  };

  void note_frames(const Submap& submap, int64_t after_revision);
  bool is_placed() const;  // somebody has said what the map is made of
  bool choose_map();       // true if the served map is now made of other submaps than before
  bool has_present_in_map() const;
  std::set<SubmapKey> to_be_kept(const std::set<SubmapKey>& map) const;
  const Counted& count(const AtlasSubmap& owner, const std::vector<const Submap*>& before) const;

  std::map<SubmapKey, AtlasSubmap> submaps_;
  std::map<ImageId, FrameRecord> frames_;
  std::map<int64_t, int64_t> frames_of_;  // by session, how many
  std::map<int64_t, StillMask> masks_;
  std::vector<Link> links_;
  std::set<int64_t> present_;
  int64_t revision_ = 0;
  mutable std::map<SubmapKey, Counted> counted_;
};

}  // namespace rumi::map_server
