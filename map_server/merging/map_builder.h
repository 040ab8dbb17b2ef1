// SPDX-License-Identifier: BSD-3-Clause
// Makes one map of submaps (paper, section IV.C): finds which hang together, places those that hang on the anchor,
// bends them where their joints ask for it, welds and adjusts them. Knows no time and no threads: the same submaps in
// the same order of calls give the same map.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "map_server/links/link.h"
#include "map_server/merging/groups.h"
#include "map_server/merging/map_part.h"
#include "map_server/merging/submap_pair.h"
#include "map_server/model/map_association.h"
#include "map_server/model/map_bundle.h"
#include "map_server/model/map_graph.h"
#include "map_server/model/map_model.h"
#include "map_server/model/post_culling.h"
#include "map_server/places/place_search.h"

namespace rumi::map_server {

struct MapBuilderOptions {
  PairOptions pairs;
  MapGraphOptions graph;
  MapBundleOptions bundle;
  AssociationOptions association;
  PlaceSearchOptions places;
  PostCullingOptions culling;
  int joined_points = 15;      // that two views share, for there to be no need to look for their similarity
  int weld_neighbours = 30;    // views around what is new that are adjusted with it
  int weld_keyframes = 500;    // of the submaps around what is new that are bent with it, about
  int association_rounds = 2;  // of Scope::kAll: association, then bundle adjustment; the radius is halved each time
};

struct MapBuildReport {
  int members = 0;         // submaps that hang together
  int views = 0;           // of the map
  int adjusted_views = 0;  // of those
  int points = 0, observations = 0, outliers = 0;
  double rmse = 0;              // reprojection, sigma
  int observed = 0, fused = 0;  // by association
};

using CulledSubmaps = std::map<SubmapKey, std::shared_ptr<const Submap>>;

struct BuiltMap {
  // Together the submaps that form the map. No placements: nothing was joined or adjusted.
  std::map<SubmapKey, Placement> placements;
  std::set<SubmapKey> unmoved;
  CulledSubmaps culled;  // the next revision of back submaps of it, without what it can do without; placed like that
  MapBuildReport report;
};

class MapBuilder {
 public:
  enum class Scope {
    kWeld,      // submaps that have been joined since the last build, and what is around them; else nothing
    kOnTheWay,  // the whole map, by what its submaps have in common: one that still grows
    kAll,       // the whole map, and every image in which its points are found
  };

  // `cancel`, if given and true, makes every call return soon; what it returns is to be thrown away.
  explicit MapBuilder(const MapBuilderOptions& options, const std::atomic<bool>* cancel = nullptr)
      : options_(options), cancel_(cancel), places_(options.places) {
    options_.bundle.cancel = cancel;
  }

  using Submaps = std::map<SubmapKey, const Submap*>;

  // A map of an earlier session, that stays as it is to the bit: what comes is placed in it. These submaps must be
  // among the placed ones in every build(). Nothing is culled then.
  void fix(std::set<SubmapKey> submaps);

  // What they have comes before what earlier ones have left: it is the map, with what hangs together with it.
  void prefer(std::set<int64_t> sessions) { preferred_ = std::move(sessions); }

  // Looks at every pair of submaps of which one has changed since it was looked at, and for the place of every keyframe
  // that is new.
  void find_links(const Submaps& submaps);
  // One for every two submaps that have something in common, of each kind: accepted and refused ones.
  std::vector<Link> links() const;

  // The submaps that hang together by accepted links and have the most frames, with or without a front submap among
  // them. `placed`: where submaps are in the map as it is; they stay there until the adjustment. `kept`: where others
  // are in a map of earlier sessions, which counts instead of it as soon as one of them hangs together with the rest.
  BuiltMap build(const Submaps& submaps, const std::map<SubmapKey, Placement>& placed, Scope scope = Scope::kAll,
                 const std::map<SubmapKey, Placement>& kept = {});

 private:
  using Pair = SubmapPair;
  // What hangs one submap on another.
  struct Tie {
    const Link* link = nullptr;
    int64_t utime_a_us = 0, utime_b_us = 0;  // where
  };
  using Placed = std::map<SubmapKey, PlacedSubmap>;
  using Placements = std::map<SubmapKey, Placement>;

  std::vector<Tie> ties(const Submaps& submaps) const;
  // No need, or no use, to compare how the two look.
  bool is_joined(const Place& a, const Place& b) const;
  Groups tied() const;
  // Of a map that another builder made, this one may find fewer ties than that one had: without a reason it does not
  // come apart. What a tie holds together since is the tie's.
  void inherit(const Placements& placed, const Placements& kept);
  // The largest group, in frames of the sessions that are preferred and then of all, of submaps that hang together.
  // That two were placed before is no reason: a tie that turned out to be wrong holds nothing any more.
  std::set<SubmapKey> choose_members(const Submaps& submaps) const;
  // The members, after those of all other submaps were searched for once more among the places of the members.
  std::set<SubmapKey> search_beside(const std::set<SubmapKey>& members, const Submaps& submaps);
  // Of the members, what is looked at: all, or what lies around those that are new.
  MapPart part_of(Scope scope, const std::set<SubmapKey>& members, const Submaps& submaps,
                  const Placements& placed) const;
  // The submap whose beginning stays where it is: a front submap if there is one that is where the map is.
  SubmapKey choose_anchor(const Submaps& submaps, const MapPart& part, const Placements& placed) const;
  Placed place_members(const Submaps& submaps, const MapPart& part, SubmapKey anchor, const Placements& placed) const;
  // An accepted link, one of the two, and its joints.
  struct KnownLink {
    Pair* pair = nullptr;
    int place = kNone;  // number in places_.found()
    LinkJoints joints = {};
  };
  std::vector<KnownLink> known_links(const Placed& submaps);
  struct Arranged {
    MapPart part;
    SubmapKey anchor;
    Placed submaps;  // of the part
  };
  // Places the members and bends them; again without what the others contradict, and with the members that this leaves,
  // until nothing does. Nothing: none of them has a frame, or nothing joins them.
  std::optional<Arranged> arrange(Scope scope, const Submaps& submaps, const Placements& in_map, const Placements& kept,
                                  std::set<SubmapKey>* members);
  // Its two sides hang together by nothing else.
  bool is_only_tie(const Link& link, const Submaps& submaps) const;
  // What the others contradict is refused. False if there is none.
  bool drop_contradicted(const std::vector<KnownLink>& links, const MapGraphReport& bent);
  // Of the links that stay, the joints that are farther out of what the map says than they may be: of one that is as a
  // whole, because nothing else ties the two sides together, the worst. False if there is none.
  bool drop_worst_joints(const std::vector<KnownLink>& links, const MapGraphReport& bent);
  void fuse_places(Placed* submaps) const;
  std::vector<int> weld_window(const MapModel& model) const;
  // What is adjusted; none: all.
  std::vector<int> window_of(Scope scope, const MapModel& model) const;
  MapBuildReport adjust(Scope scope, MapModel* model) const;
  // Leaves what the adjusted map can do without out of its back submaps, and of all else. Whatever was joined to them
  // could be joined to what is left.
  CulledSubmaps cull(const Submaps& submaps, Placed* placed, MapModel* model, Placements* placements);
  CommonImages common_images(const Submaps& submaps) const;
  bool stays_joined(const Submap& culled, const Submaps& submaps) const;
  void note_culled(const Submap& culled);
  bool cancelled() const { return cancel_ && *cancel_; }
  void note_joined(const MapModel& model, bool whole);

  MapBuilderOptions options_;
  const std::atomic<bool>* cancel_;
  std::map<std::pair<SubmapKey, SubmapKey>, Pair> pairs_;
  PlaceSearch places_;
  std::set<SubmapKey> fixed_;
  std::set<int64_t> preferred_;  // sessions
  bool has_inherited_ = false;
  std::vector<std::pair<SubmapKey, SubmapKey>> inherited_;
  std::set<SubmapKey> built_;                     // the submaps of the last build
  std::set<std::pair<ImageId, ImageId>> joined_;  // views of the map as it was built last, lower first
  SubmapContacts fused_;                          // submaps that have points in common there
};

}  // namespace rumi::map_server
