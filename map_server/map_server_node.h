// SPDX-License-Identifier: BSD-3-Clause
// map_server: takes submaps in, stores them before it acknowledges them, and answers questions about the map.
#pragma once

#include <future>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "map_server/atlas/atlas.h"
#include "map_server/map_status_pages.h"
#include "map_server/mask_intake.h"
#include "map_server/merging/map_merger.h"
#include "map_server/options.h"
#include "map_server/store/map_store.h"

namespace rumi::map_server {

class MapServerNode : public Node {
 public:
  // Throws std::runtime_error with a message for the user when the database cannot be opened (see MapStore), there is
  // no map in it to localize in, or the snapshots would take its place.
  MapServerNode(Bus& bus, const MapServerOptions& options);
  ~MapServerNode() override { store_.call_off_copies(); }  // nobody will take them

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  void finish() override;
  void stop() override;
  std::string waits_for() const override;
  // Nothing that came was found in the map (localize_only), many images of the present sessions have no pose in it, or
  // they come with another calibration than the map's.
  std::vector<std::string> complaints() const override;

  const Atlas& atlas() const { return atlas_; }
  Atlas& atlas() { return atlas_; }  // what is changed in it is stored with the next update or frame
  // All that came is joined as far as it can be, in the map of now.
  bool all_is_joined() const { return to_cull_.empty() && merger_.idle(atlas_); }
  const std::string& calibration_doubt() const { return calibration_doubt_; }
  MapStore& store() { return store_; }
  // From the first submap of the present sessions to their place in the map of earlier ones, of the images' time.
  // Nothing: they have none.
  std::optional<double> localized_after_s() const;

 private:
  void fix_map();         // localize_only
  void go_on_from_map();  // of an earlier session
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  void note_calibration(SubmapKey key);  // that its stream had another one before
  bool is_of_older_run(const submap_update_t& update, const std::string& sender);
  void on_track(const track_t& track);
  void on_mask(const mask_t& mask);
  bool has_unsaved() const { return has_unsaved_mask_ || !unsaved_frames_.empty(); }  // of what is not acknowledged
  void merge(int64_t now_us);
  void absorb(MergeResult result);
  void serve_present();
  void note_localization();
  void tell_of_localization() const;
  void write_all();
  void tell_of_map(const std::set<SubmapKey>& before) const;
  void cull_some();  // of to_cull_
  void cull(SubmapKey key, const Submap& left);
  void on_request(const map_request_t& request);
  void answer(const map_request_t& request);
  const AtlasSubmap* asked_for(const map_request_t& request);  // nothing: it has been refused
  void wait_for_merge(const map_request_t& request);
  void answer_submap(const map_request_t& request);
  void answer_placed_submap(const map_request_t& request);
  void answer_region(const map_request_t& request);
  bool waits(const map_request_t& request) const;
  void begin_answer_with_snapshot();
  void answer_with_snapshot();  // if it is there
  void send(const map_request_t& request, int8_t kind, std::vector<uint8_t> payload,
            std::optional<int64_t> checksum = {});
  void refuse(const map_request_t& request, const std::string& why);
  // The atlas and the pending frames; empty or the reason, which status() shows until it works again. Unless the whole
  // is asked for, what takes long goes on with the next ticks.
  std::string save(bool whole = false);
  void begin_snapshot();  // if there is anything new
  void end_snapshot();    // waits for it; what went wrong is shown by status() until it works again
  void tell_all();        // at once the first page, with each tick another
  void publish_map_status();

  Bus& bus_;
  MapServerOptions options_;
  MapStore store_;
  Atlas atlas_;
  MapMerger merger_;
  CulledSubmaps to_cull_;  // of the last merge, what is not yet done
  MapStatusPages status_pages_;
  ChunkSender sender_;
  ChunkReceiver receiver_;
  NewestSender sessions_{"RUMI_TRACK"};
  std::set<std::string> front_senders_;  // of front submaps, so far
  std::set<SubmapKey> fixed_;            // submaps of earlier sessions, with localize_only
  std::vector<Link> fixed_links_;        // between them
  std::set<ImageId> unsaved_frames_;
  MaskIntake masks_;
  bool has_unsaved_mask_ = false;
  std::set<std::pair<std::string, int32_t>> answering_;  // requester, request_id
  int large_answers_ = 0;                                // of those under way
  std::vector<map_request_t> waiting_;                   // for a snapshot, until what is known is merged
  std::vector<map_request_t> merged_;                    // of these, those for whom all is merged
  std::optional<map_request_t> copying_for_;             // the copy that is being made
  std::future<DatabaseBytes> copy_;
  std::future<std::string> snapshot_;  // that is being written
  bool finishing_ = false;
  std::string calibration_doubt_;
  std::string trouble_, snapshot_trouble_;  // why the last save, or snapshot, failed
  int64_t last_save_us_ = 0, last_status_us_ = 0, last_snapshot_us_ = 0;
  int64_t changes_in_snapshot_ = -1;  // of the store, when the last snapshot was begun
  int64_t last_utime_us_ = 0;
  std::optional<int64_t> first_submap_us_, localized_us_;  // of the present sessions: last_utime_us_ at that moment
  int64_t rejected_ = 0;                                   // updates and messages that made no sense, masks apart
  int64_t refused_ = 0;                                    // requests
  double busy_ms_ = 0;
  int64_t handled_ = 0;
};

}  // namespace rumi::map_server
