// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/frames_table.h"

#include "map_server/store/checked_values.h"

namespace rumi::map_server {

void write_frames(const Atlas& atlas, const std::vector<ImageId>& frames, Database& database) {
  Statement insert(database, "INSERT OR REPLACE INTO frames VALUES (?, ?, ?, ?, ?)");
  for (const ImageId& image : frames) {
    const auto it = atlas.frames().find(image);
    if (it == atlas.frames().end() || it->second.state == TrackingState::kUnknown) continue;
    const FrameRecord& record = it->second;
    insert.bind(image.stream, image.utime_us, record.session, static_cast<int>(record.state), record.submap_id).run();
  }
}

void read_frames(Database& database, Atlas* atlas) {
  Statement rows(database, "SELECT utime, stream, session, state, submap FROM frames");
  while (rows.step())
    atlas->record_frame(
        {checked_utime(rows.integer(0)), rows.integer(1)},
        {.session = rows.integer(2),
         .state = checked_enum("a state", rows.integer(3), TrackingState::kUnknown, TrackingState::kLost),
         .submap_id = static_cast<int32_t>(rows.integer(4))});
}

}  // namespace rumi::map_server
