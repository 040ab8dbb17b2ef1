// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/run_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rumi::tool {
namespace {

struct Gap {
  int64_t begin_us = 0, end_us = 0;  // times of its first frame, and of the first frame after it
  int64_t frames = 0;
};

// Frames without a pose: before the first pose, between poses, and after the last pose.
struct WithoutPose {
  int64_t before = 0, after = 0, inside = 0;
  std::vector<Gap> gaps;
};

WithoutPose find_frames_without_pose(const map_server::Atlas& atlas, int64_t after) {
  WithoutPose found;
  Gap open;
  bool any_posed = false;
  for (const auto& [image, frame] : atlas.frames()) {
    if (frame.session <= after) continue;
    if (!atlas.locate(image)) {
      if (open.frames++ == 0) open.begin_us = image.utime_us;
      continue;
    }
    open.end_us = image.utime_us;
    if (!any_posed)
      found.before = open.frames;
    else if (open.frames > 0)
      found.gaps.push_back(open);
    any_posed = true;
    open = {};
  }
  (any_posed ? found.after : found.before) = open.frames;
  for (const Gap& gap : found.gaps) found.inside += gap.frames;
  return found;
}

double seconds(int64_t us) { return 1e-6 * static_cast<double>(us); }

std::string describe(const WithoutPose& found, int64_t first_us) {
  const int64_t all = found.before + found.inside + found.after;
  std::string text = fmt::format("{} {} no pose:", all, all == 1 ? "frame has" : "frames have");
  if (found.before > 0) text += fmt::format(" {} before the first submap,", found.before);
  if (!found.gaps.empty()) {
    const Gap& longest = *std::max_element(found.gaps.begin(), found.gaps.end(),
                                           [](const Gap& a, const Gap& b) { return a.frames < b.frames; });
    text += fmt::format(" {} in {}{:.2f} s, from {:.2f} s on),", found.inside,
                        found.gaps.size() == 1 ? "a gap (" : fmt::format("{} gaps (the longest ", found.gaps.size()),
                        seconds(longest.end_us - longest.begin_us), seconds(longest.begin_us - first_us));
  }
  if (found.after > 0) text += fmt::format(" {} at the end,", found.after);
  text.pop_back();
  return text;
}

// Says why the submap is not in the map, by the one of its links that comes nearest to being accepted.
std::string why_not_in_map(const map_server::Atlas& atlas, SubmapKey key) {
  const map_server::Link* best = nullptr;
  for (const map_server::Link& link : atlas.links()) {
    if (link.a == link.b || (link.a != key && link.b != key)) continue;
    if (!best ||
        std::pair(link.accepted(), link.landmark_inliers) > std::pair(best->accepted(), best->landmark_inliers))
      best = &link;
  }
  if (!best) return "nothing links it to another submap";
  const int other = best->a == key ? best->b.id : best->a.id;
  if (best->accepted()) return fmt::format("it is linked to submap {} only, which is not in the map either", other);
  return fmt::format("its link to submap {} is refused: {}", other, best->doubt);
}

}  // namespace

std::string describe_progress(int64_t images, int64_t total, double elapsed_s) {
  const double rate_hz = static_cast<double>(images) / std::max(elapsed_s, 1e-3);
  std::string text =
      fmt::format("{}{} images, {:.1f} per second", images, total < 0 ? "" : fmt::format(" of {}", total), rate_hz);
  if (total >= images && images > 0)
    text += fmt::format(", about {:.0f} s left", std::ceil(static_cast<double>(total - images) / rate_hz));
  return text;
}

std::vector<std::string> left_out(const map_server::Atlas& atlas, int64_t after) {
  std::vector<std::string> lines;
  const auto first = std::find_if(atlas.frames().begin(), atlas.frames().end(),
                                  [after](const auto& item) { return item.second.session > after; });
  const WithoutPose without = find_frames_without_pose(atlas, after);
  if (without.before + without.inside + without.after > 0) lines.push_back(describe(without, first->first.utime_us));
  std::map<SubmapKey, int64_t> frames;
  for (const auto& [image, frame] : atlas.frames())
    if (const auto located = atlas.locate(image); frame.session > after && located && !located->owner->in_map)
      ++frames[located->owner->submap.key];
  for (const auto& [key, count] : frames)
    lines.push_back(fmt::format("{} {} of submap {}: {}", count, count == 1 ? "frame" : "frames", key.id,
                                why_not_in_map(atlas, key)));
  return lines;
}

std::string describe_localization(const AtlasCounts& counts, double after_s) {
  if (counts.earlier_frames == 0) return {};
  const std::string before =
      fmt::format("{} frames of {}", counts.earlier_frames,
                  counts.earlier_sessions == 1 ? "an earlier session"
                                               : fmt::format("{} earlier sessions", counts.earlier_sessions));
  if (!counts.is_joined)
    return fmt::format("not localized: nothing in this recording looks like the map of before ({})", before);
  return fmt::format("localized: {} of {} frames of this run in the map of before ({}){}", counts.frames_in_map,
                     counts.frames, before,
                     after_s < 0 ? "" : fmt::format(", {:.2f} s after its first submap", after_s));
}

std::vector<std::string> notes_of(const AtlasCounts& counts, double after_s, const RunMasks& masks) {
  std::vector<std::string> notes = describe_masks(masks);
  if (std::string localization = describe_localization(counts, after_s); !localization.empty())
    notes.insert(notes.begin(), std::move(localization));
  return notes;
}

}  // namespace rumi::tool
