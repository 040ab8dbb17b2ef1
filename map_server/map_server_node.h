// SPDX-License-Identifier: BSD-3-Clause
// map_server: receives submaps, stores them before it acknowledges them, and answers requests for the map.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "map_server/answers.h"
#include "map_server/atlas/atlas.h"
#include "map_server/map_status_pages.h"
#include "map_server/mask_intake.h"
#include "map_server/merging/map_merger.h"
#include "map_server/options.h"
#include "map_server/snapshot_file.h"
#include "map_server/snapshot_queue.h"
#include "map_server/store/map_store.h"
#include "map_server/write_trouble.h"

namespace rumi::map_server {

class MapServerNode : public Node {
 public:
  // Throws std::runtime_error with a message for the user if the database cannot be opened (see MapStore), has no map
  // to localize in, or would be overwritten by the snapshots.
  MapServerNode(Bus& bus, const MapServerOptions& options);
  ~MapServerNode() override { store_.call_off_copies(); }  // no caller is left for the copies

  void tick(int64_t now_us) override;
  NodeStatus status() override;
  void finish() override;
  void stop() override;
  std::string waits_for() const override;
  // Complains if no submap that came was found in the map (localize_only), if many images of the present sessions have
  // no pose in the map, or if their calibration differs from the map's.
  std::vector<std::string> complaints() const override;

  const Atlas& atlas() const { return atlas_; }
  Atlas& atlas() { return atlas_; }  // changes in it are stored with the next update or frame
  // True if all that came is joined as far as it can be in the present map.
  bool all_is_joined() const { return to_cull_.empty() && merger_.idle(atlas_); }
  const std::string& calibration_doubt() const { return calibration_doubt_; }
  MapStore& store() { return store_; }
  // Returns the time, by the images' clock, from the first submap of the present sessions to their placement in the map
  // of earlier sessions, or nullopt if they are not placed in it.
  std::optional<double> localized_after_s() const;

 private:
  void fix_map();         // fixes the stored map, for localize_only
  void go_on_from_map();  // places the submap of an earlier session, if it is the map alone
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  Result<> change_submap(SubmapKey key, const submap_update_t& update);
  Result<> save_submap(SubmapKey key);
  void note_calibration(SubmapKey key);
  bool is_of_older_run(const submap_update_t& update, const std::string& sender);
  void on_track(const track_t& track);
  void on_mask(const mask_t& mask);
  bool has_unsaved() const { return has_unsaved_mask_ || !unsaved_frames_.empty(); }  // frame states or masks
  void merge(int64_t now_us);
  void absorb(MergeResult result);
  void serve_present();
  void note_localization();
  void tell_of_localization() const;
  void write_all();
  void tell_of_map(const std::set<SubmapKey>& before) const;
  void cull_some();  // takes over some of to_cull_
  void cull(SubmapKey key, const Submap& left);
  void on_request(const map_request_t& request);
  void queue_snapshot(const map_request_t& request);
  void answer_with_snapshot(const map_request_t& request, Result<DatabaseBytes> copy);
  // Stores the atlas and the frames that are not stored yet. Unless `whole`, leaves what takes long to the next ticks.
  // Until saving works again, status() shows the Error.
  Result<> save(bool whole = false);
  void try_save(bool whole = false) { (void)save(whole); }  // status() shows the Error, and the next ticks try again
  void tell_all();  // publishes the first page of the status; each tick publishes another
  void publish_map_status();

  Bus& bus_;
  MapServerOptions options_;
  MapStore store_;
  Atlas atlas_;
  MapMerger merger_;
  CulledSubmaps to_cull_;  // submaps of the last merge that the atlas has not taken over yet
  MapStatusPages status_pages_;
  Answers answers_;
  ChunkReceiver receiver_;
  NewestSender sessions_{"RUMI_TRACK"};
  std::set<std::string> front_senders_;  // senders of front submaps so far
  std::set<SubmapKey> fixed_;            // submaps of earlier sessions, with localize_only
  std::vector<Link> fixed_links_;        // links between fixed_ submaps
  std::set<ImageId> unsaved_frames_;
  MaskIntake masks_;
  bool has_unsaved_mask_ = false;
  SnapshotQueue snapshots_;
  SnapshotFile snapshot_file_;
  bool finishing_ = false;
  std::string calibration_doubt_;
  WriteTrouble trouble_;  // the reason why save() fails
  int64_t last_save_us_ = 0, last_status_us_ = 0;
  int64_t last_utime_us_ = 0;
  // last_utime_us_ at the first submap of the present sessions, and when they were localized.
  std::optional<int64_t> first_submap_us_, localized_us_;
  int64_t rejected_ = 0;  // updates and messages rejected as malformed or old, masks apart
  double busy_ms_ = 0;
  int64_t handled_ = 0;
};

}  // namespace rumi::map_server
