// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_store.h"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "map_server/store/frames_table.h"
#include "map_server/store/links_table.h"
#include "map_server/store/masks_table.h"
#include "map_server/store/placement_tables.h"
#include "map_server/store/submap_reader.h"
#include "map_server/store/submap_writer.h"

namespace rumi::map_server {

Result<MapStore> MapStore::open(const std::string& file) {
  Result<MapDatabase> database = MapDatabase::open(file);
  if (!database) return database.error();
  return MapStore(std::move(*database));
}

Result<MapStore> MapStore::copy_in_memory(const std::string& file, std::chrono::milliseconds wait) {
  Result<MapDatabase> database = MapDatabase::copy_in_memory(file, wait);
  if (!database) return database.error();
  return MapStore(std::move(*database));
}

Result<Atlas> MapStore::load() {
  Atlas atlas;
  stored_.clear();
  is_behind_ = false;
  try {
    Database& database = database_.sqlite();
    read_frames(database, &atlas);
    read_masks(database, &atlas);
    const SubmapsByRow keys = read_submaps(database, &atlas, &stored_);
    read_placements(database, keys, stored_, &atlas);
    read_links(database, keys, &atlas);
    atlas.restore_revision(database.integer("SELECT map_revision FROM atlas"));
  } catch (const SqliteError& error) {
    return database_.explain(error);
  } catch (const std::exception& error) {
    return Error{.what = fmt::format("{} is damaged: {}", file(), error.what()), .remedy = "move it away"};
  }
  stored_masks_ = atlas.masks();
  stored_links_ = atlas.links();
  return atlas;
}

Result<> MapStore::save(const Atlas& atlas, const std::vector<ImageId>& frames,
                        std::optional<std::chrono::milliseconds> budget) {
  const Deadline deadline = budget ? std::chrono::steady_clock::now() + *budget : Deadline::max();
  try {
    Database& database = database_.sqlite();
    Transaction transaction(database);
    StoredSubmaps stored = stored_;
    const bool has_submaps = SubmapWriter(database, deadline, &stored).write(atlas);
    write_frames(atlas, frames, database);
    if (atlas.masks() != stored_masks_) write_masks(atlas, database);
    PlacementWriter placements(database, deadline, &stored);
    const bool is_whole = has_submaps && placements.write(atlas);
    if (is_whole) placements.make_valid(atlas);
    if (is_whole && atlas.links() != stored_links_) write_links(atlas, stored, database);
    const bool is_clean = placements.remove_others();
    transaction.commit();
    stored_ = std::move(stored);
    stored_masks_ = atlas.masks();
    if (is_whole) stored_links_ = atlas.links();
    is_behind_ = !is_whole || !is_clean;
  } catch (const SqliteError& error) {
    return database_.explain(error);
  }
  database_.give_back_pages();
  return {};
}

int64_t MapStore::stored_revision(SubmapKey key) const {
  const auto it = stored_.find(key);
  return it == stored_.end() ? 0 : it->second.revision;
}

Result<Atlas> load_atlas(const std::string& file, std::chrono::milliseconds wait) {
  Result<MapStore> store = MapStore::copy_in_memory(file, wait);
  if (!store) return store.error();
  return store->load();
}

}  // namespace rumi::map_server
