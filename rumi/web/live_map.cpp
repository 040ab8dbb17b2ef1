// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/live_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/running/due.h"
#include "base/text/json_text.h"
#include "base/this_process/process_name.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "bus/wire/tracking_state.h"
#include "rumi/web/submap_blob.h"
#include "slam/map/tracking_state.h"
#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/scene/projection.h"

namespace rumi::tool {
namespace {

using Json = nlohmann::ordered_json;
using viewer_offscreen::Scene;
using viewer_offscreen::SubmapView;

constexpr int64_t kRefreshUs = 1'000'000;
constexpr int64_t kWholePauseUs = 3'000'000;  // between requests for a placed submap, as it is sent whole
constexpr size_t kMostFrames = 100'000;       // frames to keep: an hour at 30 Hz
constexpr size_t kMostSpans = 1000;           // spans in the timeline; its bar is about 1000 pixels wide

std::string name_of(SubmapKey key) { return fmt::format("{}_{}", key.session, key.id); }

Json numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string hex(const cv::Vec3b& color) { return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]); }

Json submap_json(const SubmapView& view, SubmapKey key, int64_t taken, const submap_summary_t& summary) {
  return {{"name", name_of(key)},
          {"id", key.id},
          {"kind", view.kind == SubmapKind::kBack ? "back" : "front"},
          {"color", hex(viewer_offscreen::submap_color(view.kind, view.color))},
          {"placed", view.placed},
          {"closed", summary.closed != 0},
          {"frames", view.frames},
          {"keyframes", view.keyframes},
          {"landmarks", view.landmark_count},
          {"version", taken}};
}

Json merges_json(const Scene& scene) {
  Json merges = Json::array();
  for (const viewer_offscreen::MergeView& merge : scene.merges)
    merges.push_back({{"a", numbers(merge.at_a)}, {"b", numbers(merge.at_b)}, {"same_images", merge.same_images}});
  return merges;
}

// Returns the direction in the map that is upwards for the cameras.
Json up_json(const Scene& scene) {
  std::vector<const SubmapView*> placed;
  for (const SubmapView& view : scene.submaps)
    if (view.placed) placed.push_back(&view);
  return numbers(viewer_offscreen::principal_plane(placed).axes.col(2));
}

// True if the message is about an earlier frame, whose pose was found afterwards or withdrawn.
bool is_told_again(const track_t& track, const track_t& latest) {
  const uint64_t frames_ago = static_cast<uint64_t>(latest.sequence) - static_cast<uint64_t>(track.sequence);
  return track.session == latest.session && frames_ago <= kMostRetoldFrames;
}

// Calls add(span) for the latest kMostSpans spans.
template <class Spans, class Add>
void each_of_the_latest(const Spans& spans, Add add) {
  for (size_t i = spans.size() > kMostSpans ? spans.size() - kMostSpans : 0; i < spans.size(); ++i) add(spans[i]);
}

Json timeline_json(const Scene& scene) {
  const auto since_first = [&](int64_t utime_us) {
    return std::round(1e-3 * static_cast<double>(utime_us - scene.first_us)) / 1e3;
  };
  Json json{{"first", 1e-6 * static_cast<double>(scene.first_us)},
            {"end", since_first(std::max(scene.timeline.end_us, scene.first_us))},
            {"frames", scene.frames},
            {"in_map", scene.frames_in_map},
            {"filled", scene.timeline.filled}};
  json["tracked"] = json["placed"] = json["lost"] = Json::array();
  each_of_the_latest(scene.timeline.tracked, [&](const auto& span) {
    json["tracked"].push_back({since_first(span.first_us), since_first(span.last_us), span.state, span.submap});
  });
  each_of_the_latest(scene.timeline.in_map, [&](const auto& span) {
    json["placed"].push_back({since_first(span.first_us), since_first(span.last_us), span.submap});
  });
  each_of_the_latest(scene.lost, [&](const auto& span) {
    json["lost"].push_back({since_first(span.first_us), since_first(span.last_us)});
  });
  return json;
}

}  // namespace

LiveMap::LiveMap(Bus& bus)
    : bus_(bus), copies_(bus, unique_process_name("web"), [this] { changed_ = true; }), frames_(kMostFrames) {
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {.capacity = 4, .drop = DropPolicy::kDropOldest},
                              [this](const map_status_t& status) { copies_.take(status); });
}

void LiveMap::on_track(const track_t& track) {
  if (!sessions_.take(track.session, bus_.now_us())) return;
  frames_.take(track);
  if (!latest_ || !is_told_again(track, *latest_)) latest_ = track;
  changed_ = true;
}

void LiveMap::tick(int64_t now_us, bool watched) {
  copies_.tick(now_us);
  if (!watched) return;
  copies_.request_missing(now_us, kWholePauseUs);
  if (!changed_ || !is_due(now_us, refreshed_us_, kRefreshUs)) return;
  changed_ = false;
  refreshed_us_ = now_us;
  refresh();
}

std::vector<SubmapView> LiveMap::views() {
  std::erase_if(shown_, [&](const auto& entry) { return !copies_.by_key().contains(entry.first); });
  std::vector<SubmapView> views;
  for (const auto& [key, copy] : copies_.by_key()) {
    Shown& shown = shown_[key];
    if (std::exchange(shown.taken, copy.taken) != copy.taken) {
      shown.view = viewer_offscreen::view_submap(copy.submap);
      shown.view.key = key;  // the copy may still be empty, without a key
      shown.view.kind = copy.summary.kind == submap_update_t::BACK ? SubmapKind::kBack : SubmapKind::kFront;
      shown.blob = std::make_shared<const std::string>(submap_blob(shown.view));
      shown.view.landmarks = {};
    }
    views.push_back(shown.view);
  }
  return views;
}

void LiveMap::refresh() {
  viewer_offscreen::MapPicture picture = copies_.picture();
  picture.frames = frames_.by_time();
  const Scene scene = make_scene(picture, views());
  Json map{{"up", up_json(scene)},
           {"camera", {{"aspect", scene.camera_aspect}, {"half_width", scene.camera_half_width}}}};
  map["submaps"] = Json::array();
  auto copy = copies_.by_key().begin();
  for (const SubmapView& view : scene.submaps) {
    map["submaps"].push_back(submap_json(view, copy->first, copy->second.taken, copy->second.summary));
    ++copy;
  }
  map["merges"] = merges_json(scene);
  map_ = json_text(map);
  timeline_ = json_text(timeline_json(scene));
}

Json LiveMap::pose() const {
  if (!latest_) return Json::object();
  Json json{{"state", to_string(state_from_wire(latest_->state).value_or(TrackingState::kUnknown))},
            {"submap", latest_->submap_id}};
  std::optional<SE3> map_from_cam = copies_.map_from_cam(*latest_);
  const bool any_in_map = std::any_of(copies_.by_key().begin(), copies_.by_key().end(),
                                      [](const auto& entry) { return entry.second.can_be_shown_in_map(); });
  if (const auto own = from_wire(latest_->cam_from_submap); !any_in_map && own) map_from_cam = own->inverse();
  if (latest_->state != track_t::TRACKING || !map_from_cam || !map_from_cam->is_finite()) return json;
  const Eigen::Quaterniond& turn = map_from_cam->rotation;
  json["at"] = numbers(map_from_cam->translation);
  json["turn"] = {turn.w(), turn.x(), turn.y(), turn.z()};
  return json;
}

std::shared_ptr<const std::string> LiveMap::blob(const std::string& name) const {
  for (const auto& [key, shown] : shown_)
    if (name_of(key) == name) return shown.blob;
  return nullptr;
}

}  // namespace rumi::tool
