// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/gap_thinner.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rumi::ruminator {
namespace {

constexpr size_t kNeighbours = 3;     // frames on each side with which the sharpness of a frame is compared
constexpr size_t kMinFrames = 2;      // the first and the last frame
constexpr double kMinMotionPx = 1.5;  // in a full gap, frames that moved less since the last sample are left out
constexpr double kMaxStep = 3;        // largest motion between the neighbours of a dropped blurred frame, in set points
constexpr double kMinSharpness = 0.5;  // least share of the neighbours' median; with less a frame is blurred

}  // namespace

void GapThinner::add(const GapFrame& frame) {
  const bool is_small = frames_.empty() || static_cast<int>(frames_.size()) < max_frames_;
  if (!is_small && frame.path_px - frames_.back().path_px < kMinMotionPx) return;
  frames_.push_back(frame);
  thin_to(static_cast<size_t>(cap_));
}

void GapThinner::merge(const std::vector<GapFrame>& frames) {
  const auto middle = static_cast<std::ptrdiff_t>(frames_.size());
  frames_.insert(frames_.end(), frames.begin(), frames.end());
  std::inplace_merge(frames_.begin(), frames_.begin() + middle, frames_.end(),
                     [](const GapFrame& a, const GapFrame& b) { return a.sample.utime_us < b.sample.utime_us; });
  thin_to(static_cast<size_t>(cap_));
}

void GapThinner::rename(int32_t from, int32_t to) {
  for (GapFrame& frame : frames_)
    if (frame.sample.submap_id == from) frame.sample.submap_id = to;
}

std::optional<GapFrame> GapThinner::take(int64_t utime_us) {
  const auto it = std::lower_bound(frames_.begin(), frames_.end(), utime_us,
                                   [](const GapFrame& f, int64_t utime) { return f.sample.utime_us < utime; });
  if (it == frames_.end() || it->sample.utime_us != utime_us) return std::nullopt;
  GapFrame taken = *it;
  frames_.erase(it);
  return taken;
}

bool GapThinner::halve() {
  if (frames_.size() <= kMinFrames) return false;
  cap_ = std::max(static_cast<int>(kMinFrames), static_cast<int>(frames_.size() + 1) / 2);
  thin_to(static_cast<size_t>(cap_));
  return true;
}

std::vector<Sample> GapThinner::samples() const {
  std::vector<Sample> samples;
  samples.reserve(frames_.size());
  for (const GapFrame& frame : frames_) samples.push_back(frame.sample);
  return samples;
}

void GapThinner::thin_to(size_t count) {
  while (frames_.size() > std::max(count, kMinFrames))
    frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(most_dispensable()));
}

size_t GapThinner::most_dispensable() const {
  size_t best = 0;
  std::pair<bool, double> best_cost;
  for (size_t i = 1; i + 1 < frames_.size(); ++i) {
    const double step_px = frames_[i + 1].path_px - frames_[i - 1].path_px;
    const bool can_go = step_px <= kMaxStep * kGapMotionPx && is_blurred(i);
    const std::pair cost(!can_go, step_px);
    if (best != 0 && cost >= best_cost) continue;
    best = i;
    best_cost = cost;
  }
  return best;
}

bool GapThinner::is_blurred(size_t index) const {
  std::vector<double> neighbours;
  const size_t begin = index - std::min(index, kNeighbours);
  const size_t end = std::min(index + kNeighbours + 1, frames_.size());
  for (size_t i = begin; i < end; ++i)
    if (i != index && std::isfinite(frames_[i].sharpness)) neighbours.push_back(frames_[i].sharpness);
  if (neighbours.empty()) return false;
  // Takes the lower median, so that next to a cut between two scenes neither side counts as blurred.
  const auto middle = neighbours.begin() + static_cast<std::ptrdiff_t>((neighbours.size() - 1) / 2);
  std::nth_element(neighbours.begin(), middle, neighbours.end());
  return frames_[index].sharpness < kMinSharpness * *middle;
}

}  // namespace rumi::ruminator
