// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/viewer_node.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "base/due.h"
#include "base/log.h"
#include "base/process_name.h"
#include "base/stage_clock.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr int64_t kAskAgainUs = 2'000'000;  // a request without an answer is repeated
constexpr int64_t kFetchUs = 1'000'000;     // a picture that is due waits so long for what is new
constexpr int64_t kFinishTimeoutUs = 3'000'000;
constexpr int kImagesWhileDrawing = 16;  // at 30 Hz half a second: a keyframe may be among them
constexpr double kVideoFps = 10;

}  // namespace

ViewerNode::ViewerNode(Bus& bus, const ViewerOptions& options)
    : bus_(bus),
      options_(options),
      name_(unique_process_name("viewer_offscreen")),
      receiver_(bus, channels::kMapChunk, channels::kMapAck, name_, false,
                [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); },
                {.max_held_bytes = kMaxMessageBytes}) {
  if (options.series && options.output.empty())
    throw std::runtime_error("viewer_offscreen.series needs a folder to write into: viewer_offscreen.output is empty");
  if (options.series) series_.emplace(options.output, kVideoFps, options.series_goes_on);
  if (options.camera)
    bus.subscribe<image_t>(channels::kCamera, {.capacity = kImagesWhileDrawing, .drop = DropPolicy::kDropOldest},
                           [this](const image_t& image) { images_.add(image); });
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {.capacity = 4, .drop = DropPolicy::kDropOldest},
                              [this](const map_status_t& status) { on_map_status(status); });
}

void ViewerNode::on_track(const track_t& track) {
  if (!sessions_.take(track.session, bus_.now_us())) return;
  note_frame(track);
  images_.add(track);
  last_utime_us_ = std::max(last_utime_us_, track.utime);
  changed_ = true;
  if (track.state == track_t::TRACKING && from_wire(track.cam_from_submap))
    live_ = track;
  else
    live_.reset();
}

void ViewerNode::note_frame(const track_t& track) {
  const FrameNote note{track.utime, track.state, {track.session, track.submap_id}};
  if (frames_.empty() || frames_.back().utime_us < track.utime) return frames_.push_back(note);
  const auto at = std::lower_bound(frames_.begin(), frames_.end(), track.utime,
                                   [](const FrameNote& f, int64_t utime_us) { return f.utime_us < utime_us; });
  if (at->utime_us != track.utime)
    frames_.insert(at, note);
  else if (track.submap_id == kNoSubmap)
    *at = note;  // its pose was withdrawn; of one that got it afterwards the first time counts
}

void ViewerNode::on_map_status(const map_status_t& status) {
  if (!map_states_.take(status.utime, bus_.now_us())) return;
  map_.take(status);
  if (phase_ == Phase::kFinishing) since_finish_.take(status);
  std::map<SubmapKey, Copy> listed;
  for (const auto& [key, summary] : map_.submaps()) {
    if (const auto known = copies_.find(key); known != copies_.end()) listed[key] = std::move(known->second);
    listed[key].summary = summary;
  }
  copies_ = std::move(listed);  // what is not there any more is gone
  links_.clear();
  for (const auto& [number, link] : map_.links())
    links_.push_back({{link.session_a, link.submap_a},
                      {link.session_b, link.submap_b},
                      link.kind == link_t::SAME_IMAGES,
                      link.accepted != 0});
  changed_ = true;
}

ChunkReceiver::Verdict ViewerNode::on_payload(const ChunkReceiver::Payload& payload) {
  const StageClock clock("viewer_offscreen.receive");
  Copy* copy = nullptr;
  for (auto& [key, candidate] : copies_)
    if (candidate.request_id == payload.request_id && payload.request_id != 0) copy = &candidate;
  if (!copy) return {.ok = false, .reason = "not asked for"};
  copy->request_id = 0;
  submap_update_t update;
  if (payload.kind != chunk_t::SUBMAP_UPDATE) return {};  // refused: asked again in time
  std::string reason = "not a submap update";
  if (Bus::decode(payload.bytes, &update)) {
    if (update.base_revision == 0) copy->submap = Submap();
    reason = apply_submap_update(update, &copy->submap);
    copy->placement_revision = copy->asked_placement_revision;
  }
  if (!reason.empty()) {
    ++rejected_;
    copy->submap = Submap();  // whatever is wrong with it, start afresh
    log_warning("submap {} from {} is rejected: {}", copy->summary.submap_id, payload.sender, reason);
  }
  changed_ = true;
  return {.ok = reason.empty(), .reason = reason, .revision = copy->submap.revision};
}

bool ViewerNode::is_time_to_ask(const Copy& copy, int64_t now_us) const {
  if (copy.asked_us == 0) return true;
  if (copy.request_id != 0)
    return !receiver_.progress(copy.request_id).has_value() && is_due(now_us, copy.asked_us, kAskAgainUs);
  // A placed submap travels whole: no oftener than it is drawn.
  const bool travels_whole = copy.wanted_placement_revision() != 0 && phase_ == Phase::kRunning;
  const int64_t pause_us = travels_whole ? static_cast<int64_t>(options_.interval_s * 1e6) : 0;
  return is_due(now_us, copy.asked_us, std::max(pause_us, kAskAgainUs / 4));
}

void ViewerNode::request_missing(int64_t now_us) {
  for (auto& [key, copy] : copies_) {
    if (copy.up_to_date() || !is_time_to_ask(copy, now_us)) continue;
    copy.asked_placement_revision = copy.wanted_placement_revision();
    const bool is_placed = copy.asked_placement_revision != 0;
    map_request_t request{};
    request.utime = now_us;
    request.requester = name_;
    request.request_id = ++last_request_;
    request.what = is_placed ? map_request_t::PLACED_SUBMAP : map_request_t::SUBMAP;
    request.session = key.session;
    request.submap_id = key.id;
    request.base_revision = is_placed || copy.placement_revision != 0 ? 0 : copy.submap.revision;
    copy.request_id = request.request_id;
    copy.asked_us = now_us;
    bus_.publish(channels::kMapRequest, request);
  }
}

bool ViewerNode::complete() const {
  return std::all_of(copies_.begin(), copies_.end(), [](const auto& entry) { return entry.second.up_to_date(); });
}

void ViewerNode::tick(int64_t now_us) {
  receiver_.tick(now_us);
  if (phase_ == Phase::kFinished) return;
  if (phase_ == Phase::kFinishing) {
    request_missing(now_us);
    if ((since_finish_.complete() && complete()) || now_us - finish_us_ >= kFinishTimeoutUs) {
      draw();
      if (series_) series_->finish();
      phase_ = Phase::kFinished;
    }
    return;
  }
  if (last_draw_us_ == 0) last_draw_us_ = now_us;
  const int64_t interval_us = std::llround(options_.interval_s * 1e6);
  if (!changed_ || !is_due(now_us, last_draw_us_, interval_us)) return;
  // What is new travels once for each picture, however often it changes in between.
  request_missing(now_us);
  if (!complete() && !is_due(now_us, last_draw_us_, interval_us + kFetchUs)) return;
  draw();
  last_draw_us_ = now_us;
}

void ViewerNode::finish() {
  if (phase_ != Phase::kRunning) return;
  phase_ = Phase::kFinishing;
  finish_us_ = bus_.now_us();
  map_request_t request{};
  request.utime = finish_us_;
  request.requester = name_;
  request.request_id = ++last_request_;
  request.what = map_request_t::STATUS;
  bus_.publish(channels::kMapRequest, request);
}

MapPicture ViewerNode::picture() const {
  MapPicture picture;
  for (const auto& [key, copy] : copies_) {
    const std::optional<Sim3> place = copy.summary.in_map ? from_wire(copy.summary.map_from_submap) : std::nullopt;
    picture.submaps.push_back({&copy.submap, copy.can_be_shown_in_map()});
    if (live_ && key == SubmapKey{live_->session, live_->submap_id} && place)
      picture.camera = place->transform_camera(*from_wire(live_->cam_from_submap)).inverse();
  }
  picture.frames = frames_;
  picture.links = links_;
  picture.camera_view = images_.view(frames_.empty() ? last_utime_us_ : frames_.front().utime_us, [&](SubmapKey key) {
    const auto copy = copies_.find(key);
    return copy == copies_.end() ? nullptr : &copy->second.submap;
  });
  return picture;
}

void ViewerNode::draw() {
  const StageClock clock("viewer_offscreen.draw");
  const auto start = std::chrono::steady_clock::now();
  changed_ = false;
  try {
    if (!renderer_) renderer_.emplace();
    const cv::Mat image = renderer_->draw(make_scene(picture()));
    ++pictures_;
    bus_.publish(channels::kViewerImage, make_jpeg_image(last_utime_us_, image));
    report(write(image));
  } catch (const std::exception& e) {  // no OpenGL, no memory: the map is not ours to endanger
    report(e.what());
  }
  malloc_trim(0);  // a picture, and the map that it was made of, are in many pieces of all sizes
  draw_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

std::string ViewerNode::write(const cv::Mat& image) {
  if (options_.output.empty()) return {};
  const std::string error = write_png(image, (std::filesystem::path(options_.output) / "trajectory.png").string());
  return series_ && error.empty() ? series_->add(image) : error;
}

// Said once when it begins and once when it is over, not with every picture.
void ViewerNode::report(const std::string& trouble) {
  if (trouble != trouble_) {
    if (trouble.empty())
      log_info("pictures can be written again");
    else
      log_error("{}", trouble);
  }
  trouble_ = trouble;
}

NodeStatus ViewerNode::status() {
  NodeStatus status;
  int current = 0;
  for (const auto& [key, copy] : copies_) current += copy.up_to_date();
  status.detail = trouble_.empty()
                      ? fmt::format("{} pictures, {} of {} submaps up to date", pictures_, current, copies_.size())
                      : trouble_;
  status.degraded = !trouble_.empty();
  status.last_utime_us = last_utime_us_;
  status.processing_ms = draw_ms_;
  draw_ms_ = 0;
  return status;
}

}  // namespace rumi::viewer_offscreen
