// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/live/frame_notes.h"

#include <algorithm>

namespace rumi::viewer_offscreen {

void FrameNotes::take(const track_t& track) {
  const FrameNote note{track.utime, track.state, {track.session, track.submap_id}};
  const auto at = std::lower_bound(notes_.begin(), notes_.end(), track.utime,
                                   [](const FrameNote& f, int64_t utime_us) { return f.utime_us < utime_us; });
  if (at == notes_.end() || at->utime_us != track.utime)
    notes_.insert(at, note);
  else if (track.submap_id == kNoSubmap)
    *at = note;  // its pose was withdrawn; a pose that it only got afterwards does not change its note
  // Removes many at a time, because each removal moves all notes that follow.
  if (notes_.size() > most_ && notes_.size() - most_ > most_ / 8)
    notes_.erase(notes_.begin(), notes_.end() - static_cast<ptrdiff_t>(most_));
}

}  // namespace rumi::viewer_offscreen
