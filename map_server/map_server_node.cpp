// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_server_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "base/or_throw.h"
#include "base/running/due.h"
#include "base/running/is_ready.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "base/this_process/process_name.h"
#include "bus/wire/submap_update.h"
#include "bus/wire/tracking_state.h"
#include "map_server/atlas/other_calibration.h"
#include "map_server/map_messages.h"

namespace rumi::map_server {
namespace {

constexpr int64_t kStatusPeriodUs = 1'000'000;
constexpr int64_t kFrameCommitUs = 1'000'000;  // frame states and masks are written at least this often

bool is_same_file(const std::string& a, const std::string& b) {
  return std::filesystem::weakly_canonical(a) == std::filesystem::weakly_canonical(b);
}

MapStore open_store(const MapServerOptions& options) {
  return or_throw(options.localize_only ? MapStore::copy_in_memory(options.database)
                                        : MapStore::open(options.database));
}

std::string sessions_text(const Atlas& atlas) {
  std::set<int64_t> sessions;
  for (const auto& [key, owner] : atlas.submaps()) sessions.insert(key.session);
  return sessions.size() == 1 ? "a session" : fmt::format("{} sessions", sessions.size());
}

}  // namespace

MapServerNode::MapServerNode(Bus& bus, const MapServerOptions& options)
    : bus_(bus),
      options_(options),
      store_(open_store(options)),
      atlas_(or_throw(store_.load())),
      merger_(options.merge),
      answers_(bus, atlas_),
      receiver_(bus, channels::kSubmap, channels::kSubmapAck, unique_process_name("map_server"), true,
                [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); },
                {.max_held_bytes = kMaxMessageBytes}),
      snapshots_(store_, options.merge.thread,
                 {.save = [this] { return save(); },
                  // Leaves room for one copy besides kMost other answers.
                  .has_room = [this] { return answers_.large() <= Answers::kMost; },
                  .answer = [this](const map_request_t& request,
                                   Result<DatabaseBytes> copy) { answer_with_snapshot(request, std::move(copy)); }}),
      snapshot_file_(store_, options.snapshot_file, options.snapshot_s, options.merge.thread,
                     [this] {
                       if (has_unsaved()) try_save();
                     }),
      trouble_(store_.file()) {
  if (!atlas_.submaps().empty())
    log_info("{}: {} submaps, {} frames of {} before", options.database, atlas_.submaps().size(),
             atlas_.frames().size(), sessions_text(atlas_));
  if (options.snapshot_s > 0 && is_same_file(options.snapshot_file, options.database))
    throw std::runtime_error(
        fmt::format("map_server.snapshot_file is {}, the database itself; give another file", options.snapshot_file));
  atlas_.serve_larger();
  if (options.localize_only)
    fix_map();
  else if (options.merge.enabled)
    go_on_from_map();
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
  bus.subscribe<mask_t>(channels::kMask, {.capacity = 16, .drop = DropPolicy::kDropOldest},
                        [this](const mask_t& mask) { on_mask(mask); });
  bus.subscribe<map_request_t>(channels::kMapRequest, {.capacity = 64, .drop = DropPolicy::kDropNewest},
                               [this](const map_request_t& request) { on_request(request); });
}

// Places a single submap that has no placement yet: it is the map, so later submaps must be placed relative to it and
// not it relative to them.
void MapServerNode::go_on_from_map() {
  const std::set<SubmapKey> in_map = atlas_.in_map();
  if (in_map.size() == 1 && atlas_.find(*in_map.begin())->placement.revision == 0)
    or_throw(atlas_.place_map(or_throw(PlacedMap::make({{*in_map.begin(), {}}}))));
}

void MapServerNode::fix_map() {
  Placements placements;
  std::set<SubmapKey> in_map;
  for (const auto& [key, owner] : atlas_.submaps()) {
    fixed_.insert(key);
    if (!owner.in_map) continue;
    in_map.insert(key);
    placements[key] = owner.placement;
  }
  if (in_map.empty())
    throw std::runtime_error(
        fmt::format("{}: there is no map in it to localize in (map_server.localize_only)", options_.database));
  fixed_links_ = atlas_.links();
  or_throw(atlas_.place_map(or_throw(PlacedMap::make(std::move(placements)))));  // so that no larger submap replaces it
  merger_.fix(fixed_, in_map);
}

ChunkReceiver::Verdict MapServerNode::on_payload(const ChunkReceiver::Payload& payload) {
  const StageClock clock("map_server.receive");
  const double start_s = thread_cpu_s();
  submap_update_t update;
  if (payload.kind != chunk_t::SUBMAP_UPDATE || !Bus::decode(payload.bytes, &update)) {
    ++rejected_;
    return {.ok = false, .reason = fmt::format("payload of kind {} is no submap update", payload.kind)};
  }
  const SubmapKey key{update.session, update.submap_id};
  if (is_of_older_run(update, payload.sender)) {
    ++rejected_;
    return {.ok = false, .reason = fmt::format("session {} is of an older run than the one on this bus", key.session)};
  }
  const bool is_new = !atlas_.find(key);
  if (update.kind == submap_update_t::FRONT && !fixed_.contains(key)) atlas_.note_present(key.session);
  Result<> stored = change_submap(key, update);
  if (stored) {
    if (is_new) note_calibration(key);
    stored = save_submap(key);
  } else {
    ++rejected_;
    log_warning("a submap update from {} is rejected: {}", payload.sender, stored.error().text());
  }
  if (!options_.merge.enabled) serve_present();  // no merge will join the session to the map
  note_localization();
  busy_ms_ += 1e3 * (thread_cpu_s() - start_s);
  ++handled_;
  return {.ok = stored.has_value(), .reason = stored.error_text(), .revision = store_.stored_revision(key)};
}

Result<> MapServerNode::change_submap(SubmapKey key, const submap_update_t& update) {
  if (fixed_.contains(key))
    return Error{fmt::format("submap {} of session {} is of the map, which stays as it is (map_server.localize_only)",
                             key.id, key.session)};
  return atlas_.change_submap(key, [&update](Submap* submap) { return apply_submap_update(update, submap); });
}

// Saves even if the update brought nothing new, because it may have been applied before without being stored.
Result<> MapServerNode::save_submap(SubmapKey key) {
  const AtlasSubmap* owner = atlas_.find(key);
  Result<> saved = save();
  while (saved && owner && store_.stored_revision(key) < owner->submap.revision) saved = save();
  return saved;
}

// Warns once if the stream had another calibration in earlier sessions: another one was given, or the camera was
// calibrated again.
void MapServerNode::note_calibration(SubmapKey key) {
  const AtlasSubmap* owner = atlas_.find(key);
  if (!owner || owner->submap.kind != SubmapKind::kFront || !calibration_doubt_.empty()) return;
  const std::string difference = other_calibration(atlas_, owner->submap);
  if (difference.empty()) return;
  calibration_doubt_ = fmt::format(
      "the calibration differs from that of this stream in {}: {}; the map joins both where they fit, and is bent by "
      "it: give the calibration of before (--camera FILE), or begin a new map (--fresh)",
      options_.database, difference);
  log_warning("{}", calibration_doubt_);
}

// True for front submaps of a log that is played beside a running front_tracker. False for a sender that was accepted
// before, even if the session is older: a front_tracker may still send submaps of its last session. False for all back
// submaps, because their windows may have waited in the spool since earlier sessions.
bool MapServerNode::is_of_older_run(const submap_update_t& update, const std::string& sender) {
  if (update.kind != submap_update_t::FRONT || front_senders_.contains(sender)) return false;
  if (sessions_.is_older(update.session, bus_.now_us())) return true;
  front_senders_.insert(sender);
  return false;
}

void MapServerNode::on_track(const track_t& track) {
  const std::optional<TrackingState> state = state_from_wire(track.state);
  if (!state) {
    ++rejected_;
    return;
  }
  if (!sessions_.take(track.session, bus_.now_us())) return;
  atlas_.note_present(track.session);
  const FrameRecord record{.session = track.session, .state = *state, .submap_id = track.submap_id};
  const ImageId image{track.utime, track.stream};
  if (atlas_.record_frame(image, record)) unsaved_frames_.insert(image);
  last_utime_us_ = std::max(last_utime_us_, track.utime);
}

void MapServerNode::on_mask(const mask_t& mask) {
  if (sessions_.is_older(mask.session, bus_.now_us())) return;
  if (masks_.take(mask, &atlas_)) has_unsaved_mask_ = true;
}

Result<> MapServerNode::save(bool whole) {
  const StageClock clock("map_server.store");
  last_save_us_ = bus_.now_us();
  const auto budget = whole || !options_.merge.thread ? std::nullopt : std::optional(kSaveBudget);
  Result<> saved = store_.save(atlas_, {unsaved_frames_.begin(), unsaved_frames_.end()}, budget);
  if (saved) {
    unsaved_frames_.clear();
    has_unsaved_mask_ = false;
  }
  trouble_.note(saved);
  return saved;
}

void MapServerNode::on_request(const map_request_t& request) {
  const StageClock clock("map_server.answer");
  if (request.requester.empty()) {
    ++rejected_;
    return;
  }
  if (answers_.is_under_way(request)) return;  // a requester that has got no answer yet repeats its request
  if (request.what == map_request_t::STATUS) return tell_all();
  if (request.what == map_request_t::SNAPSHOT) return queue_snapshot(request);
  answers_.answer(request);
}

// Queues the snapshot even if other answers are being sent: otherwise a viewer that requests one submap after another
// could delay a snapshot for ever.
void MapServerNode::queue_snapshot(const map_request_t& request) {
  if (snapshots_.contains(request)) return;
  constexpr int64_t kMost = TransferOptions().max_payload_bytes;
  if (store_.bytes() > kMost)
    return answers_.refuse(request,
                           fmt::format("the database has {} bytes, at most {} are sent; copy its file instead, or what "
                                       "map_server.snapshot_s makes",
                                       store_.bytes(), kMost));
  if (snapshots_.size() >= static_cast<size_t>(Answers::kMost))
    return answers_.refuse(request, "busy with other requests; ask again later");
  merger_.hurry();
  snapshots_.add(request);
  merge(bus_.now_us());
}

void MapServerNode::answer_with_snapshot(const map_request_t& request, Result<DatabaseBytes> copy) {
  if (!copy) return answers_.refuse(request, copy.error().text());
  answers_.send(request, chunk_t::DATABASE, std::move(copy->bytes), copy->checksum);
}

void MapServerNode::merge(int64_t now_us) {
  cull_some();
  if (!to_cull_.empty()) return;  // the next build must see the culled submaps
  std::optional<MergeResult> result = merger_.tick(now_us, atlas_);
  // A build of the whole map that began before the request lacks the submaps that came since.
  const bool all_is_merged =
      merger_.idle(atlas_) || (result && result->scope == BuildScope::kAll && !merger_.hurried());
  if (result) absorb(std::move(*result));
  if (all_is_merged) snapshots_.note_all_is_merged();
  snapshots_.tick();
}

void MapServerNode::absorb(MergeResult result) {
  result.links.insert(result.links.end(), fixed_links_.begin(), fixed_links_.end());
  or_throw(atlas_.set_links(std::move(result.links)));  // the merger has checked links and placements
  if (!result.map.placements().empty()) {
    to_cull_ = std::move(result.culled);
    cull_some();
    const std::set<SubmapKey> before = atlas_.in_map();
    merger_.free(or_throw(atlas_.place_map(std::move(result.map))));
    tell_of_map(before);
    log_debug("adjusted: {} images, {} points, {:.2f} px, {:.1f} s", result.report.views, result.report.points,
              result.report.rmse, result.cpu_s);
    tell_all();
  }
  serve_present();
  note_localization();
  try_save();
}

// Serves the present sessions once a build has failed to join them to the map of earlier sessions.
void MapServerNode::serve_present() {
  if (options_.localize_only || !atlas_.serve_present()) return;
  log_info("nothing joins this session to the {} frames of before yet: until then it is a map of its own",
           atlas_.count_frames().earlier);
  tell_all();
}

// Records the time when the present sessions get their first submap, and when they are joined to the map of earlier
// sessions.
void MapServerNode::note_localization() {
  if (localized_us_) return;
  const auto is_present = [this](const auto& item) { return atlas_.present().contains(item.first.session); };
  if (!first_submap_us_ && std::any_of(atlas_.submaps().begin(), atlas_.submaps().end(), is_present))
    first_submap_us_ = last_utime_us_;
  if (atlas_.count_frames().is_joined) localized_us_ = last_utime_us_;
}

void MapServerNode::tell_of_localization() const {
  const Atlas::FrameCounts counts = atlas_.count_frames();
  if (options_.localize_only && localized_us_)
    log_info("localized: {} of {} frames of this run in {}", counts.present_in_map, counts.present, options_.database);
}

std::vector<std::string> MapServerNode::complaints() const {
  constexpr double kWhole = 0.9;
  const Atlas::FrameCounts counts = atlas_.count_frames();
  std::vector<std::string> sentences;
  if (!calibration_doubt_.empty()) sentences.push_back(calibration_doubt_);
  if (options_.localize_only && !localized_us_ && counts.present > 0)
    sentences.push_back(fmt::format("not localized: nothing that came looks like {}", options_.database));
  // Without finish() the last submaps are not merged, so a stopped server does not complain that they are missing.
  const bool is_part = finishing_ && counts.present_in_map > 0 &&
                       static_cast<double>(counts.present_in_map) < kWhole * static_cast<double>(counts.present);
  if (options_.merge.enabled && is_part)
    sentences.push_back(fmt::format(
        "the map has a pose for {} of {} images of this run only; `rumi up -o FOLDER` and `rumi snapshot` say what is "
        "left out",
        counts.present_in_map, counts.present));
  return sentences;
}

std::optional<double> MapServerNode::localized_after_s() const {
  if (!first_submap_us_ || !localized_us_) return std::nullopt;
  return 1e-6 * static_cast<double>(*localized_us_ - *first_submap_us_);
}

// Logs one line if the set of submaps in the map has changed. A mere adjustment of their placements is not logged.
void MapServerNode::tell_of_map(const std::set<SubmapKey>& before) const {
  const std::set<SubmapKey> now = atlas_.in_map();
  const auto without = [](const std::set<SubmapKey>& some, const std::set<SubmapKey>& others) {
    std::set<SubmapKey> rest;
    std::set_difference(some.begin(), some.end(), others.begin(), others.end(), std::inserter(rest, rest.end()));
    return rest;
  };
  const std::set<SubmapKey> come = without(now, before), gone = without(before, now);
  if (come.empty() && gone.empty()) return;
  log_info("{} {} one map: {} of {} frames{}{}", describe(now), now.size() == 1 ? "is" : "are", atlas_.frames_in_map(),
           atlas_.frames().size(), come.empty() || before.empty() ? "" : fmt::format("; new in it: {}", describe(come)),
           gone.empty() ? "" : fmt::format("; no longer in it: {}", describe(gone)));
}

// Takes over culled submaps. A live system stops after kSaveBudget, and takes the rest in the next ticks. Culling does
// not change where a submap lies, so the map stays valid while only some of its submaps are culled.
void MapServerNode::cull_some() {
  const auto begin = std::chrono::steady_clock::now();
  while (!to_cull_.empty()) {
    cull(to_cull_.begin()->first, *to_cull_.begin()->second);
    to_cull_.erase(to_cull_.begin());
    if (options_.merge.thread && std::chrono::steady_clock::now() - begin >= kSaveBudget) return;
  }
}

void MapServerNode::cull(SubmapKey key, const Submap& left) {
  const Submap& all = atlas_.find(key)->submap;
  log_debug("back submap {}: the map can do without {} of its {} keyframes and {} of its {} landmarks", key.id,
            all.keyframes.size() - left.keyframes.size(), all.keyframes.size(),
            all.landmarks.size() - left.landmarks.size(), all.landmarks.size());
  const auto replace = [&left](Submap* submap) -> Result<> {
    if (submap->revision + 1 == left.revision) *submap = left;
    return {};
  };
  or_throw(atlas_.change_submap(key, replace));
}

void MapServerNode::tick(int64_t now_us) {
  receiver_.tick(now_us);
  answers_.tick(now_us);
  merge(now_us);
  const bool must_save = has_unsaved() || !trouble_.is_over();
  const bool goes_on = store_.is_behind() && trouble_.is_over();
  if (goes_on || (must_save && is_due(now_us, last_save_us_, kFrameCommitUs))) try_save();
  if (status_pages_.round_goes_on() || is_due(now_us, last_status_us_, kStatusPeriodUs)) publish_map_status();
  snapshot_file_.tick(now_us);
}

// Merges what is left. If the process must end soon, stop() is called instead.
void MapServerNode::finish() {
  finishing_ = true;
  merger_.hurry();
  merge(bus_.now_us());
  write_all();
}

void MapServerNode::stop() {
  write_all();
  tell_of_localization();
}

void MapServerNode::write_all() {
  try_save(/*whole=*/true);
  tell_all();
  snapshot_file_.write_now(bus_.now_us());
}

NodeStatus MapServerNode::status() {
  NodeStatus status;
  const std::string& trouble = trouble_.is_over() ? snapshot_file_.trouble().text() : trouble_.text();
  status.degraded = !trouble.empty() || merger_.in_doubt();
  status.detail = !trouble.empty()
                      ? trouble
                      : fmt::format("{} submaps, {} of {} frames in the map, {} rejected, {} refused",
                                    atlas_.submaps().size(), atlas_.frames_in_map(), atlas_.frames().size(),
                                    rejected_ + masks_.rejected() + receiver_.dropped(), answers_.refused());
  if (merger_.refused().count() > 0) status.detail += "; " + merger_.refused().text();
  if (const std::set<SubmapKey> left_out = merger_.left_out(); !left_out.empty())
    status.detail += fmt::format("; left out until changed: {}", describe(left_out));
  status.last_utime_us = last_utime_us_;
  status.processing_ms = handled_ > 0 ? busy_ms_ / static_cast<double>(handled_) : 0;
  busy_ms_ = 0;
  handled_ = 0;
  return status;
}

std::string MapServerNode::waits_for() const {
  if (!answers_.is_idle() || snapshots_.is_copying())
    return "somebody who asked for a part of the map has not all of it";
  if (snapshots_.has_merged() || status_pages_.round_goes_on()) return "the map is not told of";
  if (store_.is_behind() && trouble_.is_over()) return fmt::format("{} is not written", options_.database);
  if (finishing_ && !(to_cull_.empty() && merger_.idle(atlas_))) return "submaps are not joined";
  return {};
}

void MapServerNode::tell_all() {
  status_pages_.begin_round();
  publish_map_status();
}

void MapServerNode::publish_map_status() {
  last_status_us_ = bus_.now_us();
  map_status_t message = status_pages_.next(atlas_, bus_.now_us());
  message.localized_after_s = localized_after_s().value_or(-1);
  message.database_bytes = store_.bytes();
  message.merging = merger_.running() || snapshots_.size() > 0 || snapshots_.is_copying();
  bus_.publish(channels::kMapStatus, message);
}

}  // namespace rumi::map_server
