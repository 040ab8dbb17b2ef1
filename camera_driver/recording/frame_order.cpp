// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/frame_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "formats/times/timestamps.h"
#include "slam/numeric/steps.h"

namespace rumi::camera_driver {
namespace {

constexpr double kMaxDisorder = 0.1;    // share of steps that go back; above it the times are in disorder
constexpr double kMaxDuplicates = 0.5;  // share of frames with another one's time; above it the times are useless
constexpr size_t kFew = 4;          // frames; as many in a row may have wrong times, or be stored too early or too late
constexpr size_t kNearPlaces = 16;  // frames between a frame's stored place and its place by time, at most
constexpr int64_t kNearPeriods = 10;  // median periods between a frame that is moved and its nearest neighbour, at most
constexpr size_t kMostSessions = 3;
constexpr int64_t kLongPauseUs = 60'000'000;
constexpr int64_t kManyTimes = 10;

using Frames = std::vector<size_t>;  // numbers of frames

class Ordering {
 public:
  explicit Ordering(const std::vector<int64_t>& utimes_us) : times_(utimes_us) {}

  Result<FrameOrder> run() {
    for (const Result<>& checked : {check_duplicates(), check_clocks()})
      if (!checked) return checked.error();
    if (const int64_t step_us = usual_step(times_); step_us > 0) period_us_ = step_us;
    if (is_in_disorder())
      sort_all();
    else
      follow();
    merge_parts();
    cut_ends();
    hand_out();
    return std::move(order_);
  }

 private:
  int64_t time(size_t frame) const { return times_[frame]; }
  bool earlier(size_t a, size_t b) const { return time(a) < time(b); }

  Result<> check_duplicates() const {
    std::vector<int64_t> sorted = times_;
    std::sort(sorted.begin(), sorted.end());
    const auto distinct = static_cast<size_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
    const size_t doubled = sorted.size() - distinct;
    if (static_cast<double>(doubled) <= kMaxDuplicates * static_cast<double>(sorted.size())) return {};
    if (distinct == 1)
      return Error{fmt::format("all of its {} images have the time {:.6f} s; give --rate HZ to make new times",
                               times_.size(), static_cast<double>(times_.front()) * 1e-6)};
    return Error{fmt::format("of its {} images {} have the time of another one; give --rate HZ to make new times",
                             times_.size(), doubled)};
  }

  // An Error if the times come from two clocks in turn: each clock rises, at least every other image is of another
  // clock than the image before, and sorting would move images far from where they are stored.
  Result<> check_clocks() const {
    std::array<Frames, 2> clocks;
    size_t last = 0, turns = 0;
    for (size_t i = 0; i < times_.size(); ++i) {
      const auto follows = [&](size_t clock) { return clocks[clock].empty() || !earlier(i, clocks[clock].back()); };
      const auto gap = [&](size_t clock) {
        return clocks[clock].empty() ? INT64_MAX : time(i) - time(clocks[clock].back());
      };
      if (!follows(0) && !follows(1)) return {};
      const size_t clock = follows(0) && (!follows(1) || gap(0) <= gap(1)) ? 0 : 1;
      clocks[clock].push_back(i);
      turns += clock != last ? 1 : 0;
      last = clock;
    }
    if (2 * turns < times_.size() || median_displacement() <= kNearPlaces / 2) return {};
    return Error{fmt::format(
        "the times of its images are of two clocks in turn ({:.6f} s and {:.6f} s are those of two images in a row); "
        "give --rate HZ to make new times",
        static_cast<double>(time(0)) * 1e-6, static_cast<double>(time(1)) * 1e-6)};
  }

  // Returns the median distance, in frames, between a frame's stored place and its place by time.
  size_t median_displacement() const {
    Frames sorted = all_by_time();
    std::vector<size_t> displacements;
    for (size_t i = 0; i < sorted.size(); ++i) displacements.push_back(std::max(i, sorted[i]) - std::min(i, sorted[i]));
    return median(&displacements);
  }

  Frames all_by_time() const {
    Frames all(times_.size());
    std::iota(all.begin(), all.end(), 0);
    std::stable_sort(all.begin(), all.end(), [this](size_t a, size_t b) { return earlier(a, b); });
    return all;
  }

  bool is_in_disorder() const {
    size_t back = 0;
    for (size_t i = 1; i < times_.size(); ++i) back += time(i) < time(i - 1) ? 1 : 0;
    return back > kFew && static_cast<double>(back) > kMaxDisorder * static_cast<double>(times_.size());
  }

  void sort_all() {
    parts_.emplace_back();
    for (const size_t frame : all_by_time()) {
      if (!parts_[0].empty() && time(parts_[0].back()) == time(frame))
        order_.duplicates.push_back(frame);
      else
        parts_[0].push_back(frame);
    }
    order_.is_sorted = true;
  }

  // Goes through the frames as they are stored. Where the time goes back, either earlier frames with later times or the
  // following frames with earlier times are wrong: the smaller group is in doubt. If both have more than kFew frames,
  // the clock was set back, and a new part begins.
  void follow() {
    parts_.emplace_back();
    for (size_t i = 0; i < times_.size(); ++i) {
      Frames& part = parts_.back();
      if (part.empty() || time(i) > time(part.back())) {
        part.push_back(i);
        continue;
      }
      if (time(i) == time(part.back())) {
        order_.duplicates.push_back(i);
        continue;
      }
      const auto from =
          std::lower_bound(part.begin(), part.end(), i, [this](size_t a, size_t b) { return earlier(a, b); });
      const auto before = static_cast<size_t>(part.end() - from);
      const size_t after = frames_not_after(time(part.back()), i);
      if (std::min(before, after) > kFew) {
        put_back();
        parts_.push_back({i});
      } else if (before < after) {
        in_doubt_.insert(in_doubt_.end(), from, part.end());
        part.erase(from, part.end());
        part.push_back(i);
      } else {
        in_doubt_.push_back(i);
      }
    }
    put_back();
  }

  // Counts the frames from `begin` up to the first one later than utime_us; returns the number of all frames if they
  // are more than kFew.
  size_t frames_not_after(int64_t utime_us, size_t begin) const {
    size_t count = 0;
    while (begin + count < times_.size() && count <= kFew && time(begin + count) <= utime_us) ++count;
    return count > kFew ? times_.size() : count;
  }

  // Puts each frame in doubt into the current part where its time belongs, if that is near its stored place; else its
  // time is wrong.
  void put_back() {
    Frames& part = parts_.back();
    const Frames sure = part;  // ordered by stored place, and also by time
    for (const size_t frame : in_doubt_) {
      const auto by_time =
          std::lower_bound(sure.begin(), sure.end(), frame, [this](size_t a, size_t b) { return earlier(a, b); });
      const auto by_place = std::lower_bound(sure.begin(), sure.end(), frame);
      int64_t nearest_us = INT64_MAX;
      if (by_time != sure.end()) nearest_us = time(*by_time) - time(frame);
      if (by_time != sure.begin()) nearest_us = std::min(nearest_us, time(frame) - time(*(by_time - 1)));
      const bool is_near =
          static_cast<size_t>(std::abs(by_time - by_place)) <= kNearPlaces && nearest_us / kNearPeriods <= period_us_;
      const auto at =
          std::lower_bound(part.begin(), part.end(), frame, [this](size_t a, size_t b) { return earlier(a, b); });
      if (!is_near) {
        order_.wrong_times.push_back(frame);
      } else if (at != part.end() && time(*at) == time(frame)) {
        order_.duplicates.push_back(frame);
      } else {
        part.insert(at, frame);
        order_.is_sorted = true;
      }
    }
    in_doubt_.clear();
  }

  // Joins the parts into one if there are more than kMostSessions and their times do not overlap: a clock is set back
  // once or twice, so many parts are one recording in disorder.
  void merge_parts() {
    std::vector<Frames> sorted = parts_;
    std::sort(sorted.begin(), sorted.end(),
              [this](const Frames& a, const Frames& b) { return earlier(a.front(), b.front()); });
    for (size_t i = 1; i < sorted.size(); ++i)
      if (!earlier(sorted[i - 1].back(), sorted[i].front())) return;
    if (sorted.size() <= kMostSessions) return;
    order_.is_sorted = true;
    parts_.assign(1, {});
    for (const Frames& part : sorted) parts_[0].insert(parts_[0].end(), part.begin(), part.end());
  }

  // Cuts off a few frames at either end if the pause between them and the rest is many times as long as the rest.
  void cut_ends() {
    Frames& first = parts_.front();
    Frames& last = parts_.back();
    for (size_t few = std::min(kFew, first.size() - 1); few > 0; --few) {
      if (!is_far_away(time(first[few]) - time(first[few - 1]), time(first.back()) - time(first[few]))) continue;
      order_.wrong_times.insert(order_.wrong_times.end(), first.begin(),
                                first.begin() + static_cast<std::ptrdiff_t>(few));
      first.erase(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(few));
      break;
    }
    for (size_t few = std::min(kFew, last.size() - 1); few > 0; --few) {
      const size_t kept = last.size() - few;
      if (!is_far_away(time(last[kept]) - time(last[kept - 1]), time(last[kept - 1]) - time(last[0]))) continue;
      order_.wrong_times.insert(order_.wrong_times.end(), last.begin() + static_cast<std::ptrdiff_t>(kept), last.end());
      last.resize(kept);
      break;
    }
  }

  static bool is_far_away(int64_t gap_us, int64_t others_us) {
    return gap_us > kLongPauseUs && gap_us / kManyTimes > others_us && others_us > 0;
  }

  void hand_out() {
    int64_t begin_us = 0;  // time elapsed at the beginning of the part
    for (size_t p = 0; p < parts_.size(); ++p) {
      const int64_t first_us = time(parts_[p].front());
      for (const size_t frame : parts_[p])
        order_.frames.push_back({frame, time(frame), begin_us + time(frame) - first_us, static_cast<int>(p)});
      begin_us = order_.frames.back().elapsed_us + period_us_;
    }
    std::sort(order_.duplicates.begin(), order_.duplicates.end());
    std::sort(order_.wrong_times.begin(), order_.wrong_times.end());
  }

  const std::vector<int64_t>& times_;
  int64_t period_us_ = kUsualPeriodUs;
  std::vector<Frames> parts_;
  Frames in_doubt_;
  FrameOrder order_;
};

}  // namespace

Result<FrameOrder> order_frames(const std::vector<int64_t>& utimes_us) {
  if (utimes_us.empty()) return FrameOrder();
  return Ordering(utimes_us).run();
}

FrameOrder frames_at_rate(size_t count, double rate_hz, int64_t first_us) {
  FrameOrder order;
  for (size_t i = 0; i < count; ++i) {
    const int64_t elapsed_us = std::llround(static_cast<double>(i) * 1e6 / rate_hz);
    order.frames.push_back({i, first_us + elapsed_us, elapsed_us, 0});
  }
  return order;
}

}  // namespace rumi::camera_driver
