// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/masks_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include "map_server/store/blob.h"

namespace rumi::map_server {

void write_masks(const Atlas& atlas, Database& database) {
  database.execute("DELETE FROM masks");
  Statement insert(database, "INSERT INTO masks VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (const auto& [stream, mask] : atlas.masks()) {
    const std::vector<uint8_t> png(mask.png.begin(), mask.png.end());
    insert.bind(stream, mask.session, mask.utime_us, mask.width, mask.height, mask.left_out, as_blob(png)).run();
  }
}

void read_masks(Database& database, Atlas* atlas) {
  Statement rows(database, "SELECT stream, session, utime, width, height, left_out, png FROM masks");
  while (rows.step()) {
    const auto side = [&rows](int column) {
      return static_cast<int>(std::clamp<int64_t>(rows.integer(column), 0, 1 << 30));
    };
    const std::span<const uint8_t> png = rows.blob(6);
    const StillMask mask{.session = rows.integer(1),
                         .utime_us = rows.integer(2),
                         .width = side(3),
                         .height = side(4),
                         .left_out = rows.real(5),
                         .png = {png.begin(), png.end()}};
    if (const Result<> checked = check(rows.integer(0), mask); !checked)
      throw std::runtime_error(fmt::format("the mask of stream {}: {}", rows.integer(0), checked.error().text()));
    atlas->record_mask(rows.integer(0), mask);
  }
}

}  // namespace rumi::map_server
