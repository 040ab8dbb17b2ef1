// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/map_file.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>

#include "base/whole_file.h"
#include "map_server/outputs/writers.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() : name_((fs::temp_directory_path() / "rumi-map-XXXXXX").string()) {
    if (!mkdtemp(name_.data())) throw std::runtime_error(fmt::format("{}: cannot be made", name_));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(name_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(const char* name) const { return (fs::path(name_) / name).string(); }

 private:
  std::string name_;
};

// A consistent copy, whoever else reads or writes the file.
void copy_database(const std::string& from, const std::string& to) {
  sqlite3* handle = nullptr;
  // Nothing is written, but only a connection that might removes SQLite's files beside the database at its end. A file
  // that may not be written is opened for reading all the same.
  int code = sqlite3_open_v2(from.c_str(), &handle, SQLITE_OPEN_READWRITE, nullptr);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database(handle, &sqlite3_close);
  if (code == SQLITE_OK) {
    sqlite3_busy_timeout(handle, 5000);
    const std::unique_ptr<char, decltype(&sqlite3_free)> sql(sqlite3_mprintf("VACUUM INTO %Q", to.c_str()),
                                                             &sqlite3_free);
    code = sqlite3_exec(handle, sql.get(), nullptr, nullptr, nullptr);
  }
  if (code != SQLITE_OK)
    throw std::runtime_error(fmt::format("{}: cannot be read as a map: {}", from, sqlite3_errmsg(handle)));
}

}  // namespace

map_server::Atlas load_map(const std::string& file) {
  if (!fs::is_regular_file(file)) throw std::runtime_error(fmt::format("{}: there is no such file", file));
  const TemporaryFolder folder;
  const std::string copy = folder.file("map.db");
  copy_database(file, copy);
  return map_server::MapStore(copy).load();
}

map_server::Atlas load_map_bytes(std::span<const uint8_t> bytes, const std::string& copy_to) {
  const TemporaryFolder folder;
  const std::string received = folder.file("map.db");
  WholeFile file(received);
  file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (const std::string error = file.commit(); !error.empty()) throw std::runtime_error(error);
  map_server::MapStore store(received);
  if (const std::string error = store.write_copy(copy_to); !error.empty()) throw std::runtime_error(error);
  return store.load();
}

AtlasPicture make_picture(const map_server::Atlas& atlas, const std::string& title) {
  AtlasPicture result;
  result.picture.title = title;
  for (const auto& [key, owner] : atlas.submaps()) {
    const Submap* shown = &owner.submap;
    if (owner.in_map) shown = &(result.placed[key] = map_server::place(owner.submap, owner.placement));
    result.picture.submaps.push_back({shown, owner.in_map});
  }
  for (const auto& [utime_us, frame] : atlas.frames())
    result.picture.frames.push_back({utime_us, static_cast<int8_t>(frame.state), {frame.session, frame.submap_id}});
  for (const map_server::Link& link : atlas.links())
    result.picture.links.push_back({link.a, link.b, link.kind == map_server::Link::Kind::kSameImages, link.accepted()});
  return result;
}

std::string write_run_outputs(const map_server::Atlas& atlas, const std::string& folder) {
  if (std::string error = map_server::write_outputs(atlas, folder); !error.empty()) return error;
  return viewer_offscreen::write_png(viewer_offscreen::draw_map(make_picture(atlas, "Rumi").picture),
                                     (fs::path(folder) / "trajectory.png").string());
}

AtlasCounts count(const map_server::Atlas& atlas) {
  AtlasCounts counts;
  counts.frames = static_cast<int64_t>(atlas.frames().size());
  counts.frames_in_map = atlas.frames_in_map();
  for (const auto& [utime_us, frame] : atlas.frames()) counts.tracked_frames += atlas.locate(utime_us).has_value();
  counts.submaps = static_cast<int>(atlas.submaps().size());
  for (const auto& [key, owner] : atlas.submaps()) {
    counts.keyframes += static_cast<int>(owner.submap.keyframes.size());
    counts.landmarks += static_cast<int>(owner.submap.landmarks.size());
    if (owner.submap.kind != SubmapKind::kFront) continue;
    ++counts.front_submaps;
    counts.front_submaps_in_map += owner.in_map;
  }
  return counts;
}

}  // namespace rumi::tool
