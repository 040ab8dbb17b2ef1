// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/again.h"

#include <algorithm>
#include <map>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "slam/features/lens_mask.h"

namespace rumi::tool {
namespace {

using map_server::Atlas;
using map_server::AtlasSubmap;
using map_server::LocatedFrame;
using ruminator::PlaceWindow;
using ruminator::Sample;
using ruminator::WindowCandidate;

constexpr size_t kMostCandidates = 300;  // of the islands, and as many of the map
// A map that lacks less than this part of the frames is whole, and a round that wins less is the last one.
constexpr double kLeastShare = 0.01;

template <class T>
std::vector<T> thinned(const std::vector<T>& all, size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  if (most < 2) return some;
  for (size_t k = 0; k < most; ++k) some.push_back(all[k * (all.size() - 1) / (most - 1)]);
  return some;
}

// A frame of a front submap is a sample with a pose.
Sample sample_outside_map(int64_t utime_us, const std::optional<LocatedFrame>& located) {
  Sample sample{.utime_us = utime_us};
  if (!located || located->owner->submap.kind != SubmapKind::kFront) return sample;
  sample.submap_id = located->owner->submap.key.id;
  sample.cam_from_submap = located->cam_from_submap();
  sample.is_keyframe = located->is_keyframe();
  return sample;
}

Sample sample_in_map(int64_t utime_us, const LocatedFrame& located) {
  return {.utime_us = utime_us,
          .is_keyframe = located.is_keyframe(),
          .submap_id = ruminator::kMapFrame,
          .cam_from_submap = located.cam_from_map()};
}

// Returns candidates in order of time, thinned.
std::vector<WindowCandidate> choose_candidates(const std::vector<WindowCandidate>& of_islands,
                                               const std::vector<WindowCandidate>& of_map,
                                               const std::vector<WindowCandidate>& between_keyframes) {
  std::vector<WindowCandidate> all;
  const auto take = [&all](const std::vector<WindowCandidate>& some, size_t most) {
    const std::vector<WindowCandidate> chosen = thinned(some, most);
    all.insert(all.end(), chosen.begin(), chosen.end());
  };
  take(of_islands, kMostCandidates);
  take(of_map, kMostCandidates);
  // Front_tracker's pose of a frame between keyframes may be wrong where the camera turns fast.
  const size_t enough = std::min(of_islands.size(), kMostCandidates);
  take(between_keyframes, enough - std::min(of_map.size(), enough));
  std::sort(all.begin(), all.end(),
            [](const WindowCandidate& a, const WindowCandidate& b) { return a.sample.utime_us < b.sample.utime_us; });
  return all;
}

}  // namespace

Islands find_islands(const Atlas& atlas, int64_t session, int64_t stream) {
  Islands result;
  std::map<SubmapKey, int> id_of;  // of the islands that are submaps
  std::vector<WindowCandidate> of_islands, of_map, between_keyframes;
  bool in_row = false;  // the frame before has no pose either
  const auto begin_island = [&result] {
    result.all.push_back({.id = static_cast<int>(result.all.size())});
    return result.all.back().id;
  };
  for (const auto& [image, record] : atlas.frames()) {
    if (record.session != session || image.stream != stream) continue;
    const auto located = atlas.locate(image);
    const AtlasSubmap* owner = located ? located->owner : nullptr;
    const bool continues_row = !owner && in_row;
    in_row = !owner;
    if (owner && owner->in_map) {
      (located->is_keyframe() ? of_map : between_keyframes).push_back({sample_in_map(image.utime_us, *located)});
      continue;
    }
    int island = continues_row ? result.all.back().id : -1;
    if (owner) {
      const auto [found, is_new] = id_of.try_emplace(owner->submap.key, 0);
      if (is_new) found->second = begin_island();
      island = found->second;
    } else if (!continues_row) {
      island = begin_island();
    }
    ++result.all[static_cast<size_t>(island)].frames;
    ++result.frames;
    of_islands.push_back({sample_outside_map(image.utime_us, located), island});
  }
  result.candidates = choose_candidates(of_islands, of_map, between_keyframes);
  return result;
}

Islands Again::look() const {
  return find_islands(system_.atlas, system_.ruminator.session(), system_.ruminator.stream());
}

void Again::run(int64_t most_images) {
  images_left_ = most_images;
  // A map that is whole already is not touched: to settle it means to adjust it once more.
  if (are_few(look().frames)) return;
  system_.settle();
  const Islands islands = look();
  if (are_few(islands.frames)) return;
  if (!index(islands)) return;
  for (int number = 2; !is_over() && round(number); ++number) continue;
}

bool Again::are_few(int64_t frames) const {
  return static_cast<double>(frames) < kLeastShare * static_cast<double>(system_.atlas.frames().size());
}

bool Again::is_over() const { return (system_.stop && *system_.stop) || images_left_ <= 0; }

std::vector<image_t> Again::images(const std::set<int64_t>& utimes_us) {
  std::vector<image_t> found;
  system_.recording.play_again(utimes_us, camera_driver::ImageSource::Pixels::kAsBefore);
  while (std::optional<image_t> image = system_.recording.next()) found.push_back(std::move(*image));
  return found;
}

// False if the images of the islands show nothing.
bool Again::index(const Islands& islands) {
  const StageClock clock("ruminator.places");
  std::set<int64_t> of_islands, of_map;
  for (const WindowCandidate& candidate : islands.candidates)
    (candidate.island == WindowCandidate::kInMap ? of_map : of_islands).insert(candidate.sample.utime_us);
  add_to_index(of_islands);
  if (number_in_index_.empty()) return false;
  add_to_index(of_map);
  index_.build();
  return true;
}

void Again::add_to_index(const std::set<int64_t>& utimes_us) {
  const Camera& camera = system_.recording.camera();
  const Camera working = working_camera(camera, kDefaultMaxImageSide);
  MaskReader masks(lens_mask(working));
  system_.recording.play_again(utimes_us, camera_driver::ImageSource::Pixels::kAsBefore);
  while (const std::optional<image_t> image = system_.recording.next()) {
    const Result<cv::Mat> grey = decode_working_image(*image, camera, working);
    if (!grey || !index_.add(*grey, working, masks.read(*image, grey->size()))) continue;
    number_in_index_.emplace(image->utime, number_in_index_.size());
  }
}

// Returns a window around the largest island of which no image was tried in this round; an empty one if there is none.
PlaceWindow Again::next_window(const Islands& islands) {
  std::vector<WindowCandidate> candidates;
  std::vector<size_t> number;
  std::set<int> tried;
  for (const WindowCandidate& candidate : islands.candidates) {
    const auto found = number_in_index_.find(candidate.sample.utime_us);
    if (found == number_in_index_.end()) continue;
    candidates.push_back(candidate);
    number.push_back(found->second);
    if (tried_.contains(candidate.sample.utime_us)) tried.insert(candidate.island);
  }
  const ruminator::Island* seed = nullptr;
  for (const WindowCandidate& candidate : candidates) {
    if (candidate.island == WindowCandidate::kInMap || tried.contains(candidate.island)) continue;
    const ruminator::Island& island = islands.all[static_cast<size_t>(candidate.island)];
    if (!seed || island.frames > seed->frames) seed = &island;
  }
  if (!seed) return {};
  const auto similarity = [&](size_t a, size_t b) { return index_.similarity(number[a], number[b]); };
  return choose_place_window(candidates, seed->id, similarity,
                             static_cast<int>(std::min<int64_t>(images_left_, ruminator::kPlaceWindowImages)));
}

void Again::rebuild(const PlaceWindow& window) {
  std::vector<Sample> samples;
  std::set<int64_t> utimes_us;
  for (const WindowCandidate& candidate : window.candidates) {
    if (candidate.island != WindowCandidate::kInMap) tried_.insert(candidate.sample.utime_us);
    samples.push_back(candidate.sample);
    utimes_us.insert(candidate.sample.utime_us);
  }
  images_left_ -= static_cast<int64_t>(samples.size());
  system_.ruminator.rebuild_again(std::move(samples), images(utimes_us));
  system_.settle();
}

// True if it won more than a few frames.
bool Again::round(int number) {
  const double begin_s = process_cpu_s();
  const int64_t before = system_.atlas.frames_in_map();
  tried_.clear();
  size_t windows = 0;
  while (!is_over()) {
    const Islands islands = look();
    const PlaceWindow window = next_window(islands);
    if (window.candidates.empty()) break;
    const int64_t in_map = system_.atlas.frames_in_map();
    rebuild(window);
    log_info("round {}, window {}: {} of {} islands, {} images, {} frames won", number, ++windows,
             window.islands.size(), islands.all.size(), window.candidates.size(),
             system_.atlas.frames_in_map() - in_map);
  }
  if (windows == 0) return false;
  const int64_t won = system_.atlas.frames_in_map() - before;
  log_info("round {}: {} windows, {} frames won, {:.0f} s CPU", number, windows, won, process_cpu_s() - begin_s);
  return !are_few(won);
}

}  // namespace rumi::tool
