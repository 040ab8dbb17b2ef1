// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/again.h"

#include <algorithm>
#include <map>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "ruminator/again/place_index.h"
#include "slam/features/lens_mask.h"

namespace rumi::tool {
namespace {

using map_server::Atlas;
using map_server::AtlasSubmap;
using ruminator::PlaceCandidate;
using ruminator::Sample;

constexpr size_t kMostCandidates = 300;  // of the islands, and as many of the map
constexpr double kLeastShare = 0.01;     // of the frames: a map that lacks fewer is whole

template <class T>
std::vector<T> thinned(const std::vector<T>& all, size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (size_t k = 0; k < most; ++k) some.push_back(all[k * (all.size() - 1) / (most - 1)]);
  return some;
}

Sample sample_of(int64_t utime_us, const AtlasSubmap* owner) {
  Sample sample{.utime_us = utime_us};
  const FramePose* frame = owner ? owner->submap.frame(utime_us) : nullptr;
  if (!frame || owner->submap.kind != SubmapKind::kFront) return sample;
  sample.submap_id = owner->submap.key.id;
  sample.cam_from_submap = owner->submap.cam_from_submap(*frame);
  for (const auto& [id, keyframe] : owner->submap.keyframes) sample.is_keyframe |= keyframe.utime_us == utime_us;
  return sample;
}

}  // namespace

Islands find_islands(const Atlas& atlas, int64_t session, int64_t stream) {
  Islands result;
  std::map<SubmapKey, int> id_of;  // of the islands that are submaps
  std::vector<PlaceCandidate> of_islands, of_map;
  std::set<int64_t> map_keyframes;
  for (const auto& [key, owner] : atlas.submaps())
    if (owner.in_map && owner.submap.stream == stream)
      for (const auto& [id, keyframe] : owner.submap.keyframes) map_keyframes.insert(keyframe.utime_us);
  bool in_row = false;
  const auto begin_island = [&result] {
    result.all.push_back({.id = static_cast<int>(result.all.size())});
    return result.all.back().id;
  };
  for (const auto& [image, record] : atlas.frames()) {
    if (record.session != session || image.stream != stream) continue;
    const auto located = atlas.locate(image);
    const AtlasSubmap* owner = located ? located->owner : nullptr;
    if (owner && owner->in_map) {
      in_row = false;
      if (map_keyframes.contains(image.utime_us)) of_map.push_back({sample_of(image.utime_us, owner)});
      continue;
    }
    int island = 0;
    if (owner) {
      const auto [found, is_new] = id_of.try_emplace(owner->submap.key, 0);
      if (is_new) found->second = begin_island();
      island = found->second;
      in_row = false;
    } else {
      island = in_row ? result.all.back().id : begin_island();
      in_row = true;
    }
    ++result.all[static_cast<size_t>(island)].frames;
    ++result.frames;
    of_islands.push_back({sample_of(image.utime_us, owner), island});
  }
  for (const auto* some : {&of_islands, &of_map}) {
    const std::vector<PlaceCandidate> chosen = thinned(*some, kMostCandidates);
    result.candidates.insert(result.candidates.end(), chosen.begin(), chosen.end());
  }
  std::sort(result.candidates.begin(), result.candidates.end(),
            [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.sample.utime_us < b.sample.utime_us; });
  return result;
}

void Again::run(double budget_s) {
  const double begin_s = system_.cpu_s();
  const auto is_over = [&] { return (system_.stop && *system_.stop) || system_.cpu_s() - begin_s >= budget_s; };
  for (int number = 2; !is_over() && round(number); ++number) continue;
}

std::vector<image_t> Again::images(const std::set<int64_t>& utimes_us) {
  std::vector<image_t> found;
  system_.recording.play_again(utimes_us, camera_driver::ImageSource::Pixels::kAsBefore);
  while (std::optional<image_t> image = system_.recording.next()) found.push_back(std::move(*image));
  return found;
}

// True if it won frames.
bool Again::round(int number) {
  system_.settle();
  const double begin_s = system_.cpu_s();
  const int64_t session = system_.ruminator.session(), stream = system_.ruminator.stream();
  const Islands islands = find_islands(system_.atlas, session, stream);
  const auto all = static_cast<double>(system_.atlas.frames().size());
  if (islands.all.empty() || static_cast<double>(islands.frames) < kLeastShare * all) return false;

  std::set<int64_t> utimes_us;
  for (const PlaceCandidate& candidate : islands.candidates) utimes_us.insert(candidate.sample.utime_us);
  const std::vector<image_t> candidates = images(utimes_us);
  const Camera& camera = system_.recording.camera();
  const Camera working = working_camera(camera, kDefaultMaxImageSide);
  ruminator::PlaceIndex index;
  MaskReader masks(lens_mask(working));
  std::vector<PlaceCandidate> seen;
  std::vector<const image_t*> image_of;
  {
    const StageClock clock("ruminator.places");
    size_t next = 0;
    for (const image_t& image : candidates) {
      while (next < islands.candidates.size() && islands.candidates[next].sample.utime_us < image.utime) ++next;
      if (next == islands.candidates.size() || islands.candidates[next].sample.utime_us != image.utime) continue;
      std::string ignored;
      const cv::Mat grey = decode_working_image(image, camera, working, &ignored);
      if (grey.empty() || !index.add(grey, working, masks.read(image, grey.size(), &ignored))) continue;
      seen.push_back(islands.candidates[next]);
      image_of.push_back(&image);
    }
    index.build();
  }
  std::vector<int> taken;
  const std::vector<size_t> chosen = ruminator::choose_place_window(
      seen, islands.all, [&index](size_t a, size_t b) { return index.similarity(a, b); }, ruminator::kPlaceWindowImages,
      &taken);
  if (taken.empty()) return false;
  std::vector<Sample> samples;
  std::vector<image_t> window;
  for (const size_t i : chosen) {
    samples.push_back(seen[i].sample);
    window.push_back(*image_of[i]);
  }
  const int64_t before = system_.atlas.frames_in_map();
  system_.ruminator.rebuild_again(std::move(samples), std::move(window));
  system_.settle();
  const int64_t won = system_.atlas.frames_in_map() - before;
  log_info("round {}: {} islands of {} with {} frames, {} images, {} frames won, {:.1f} s CPU", number, taken.size(),
           islands.all.size(), islands.frames, chosen.size(), won, system_.cpu_s() - begin_s);
  return won > 0;
}

}  // namespace rumi::tool
