// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/map_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

#include "base/files/file_access.h"
#include "base/files/scratch_folder.h"
#include "base/files/temporary_folder.h"
#include "base/files/whole_file.h"
#include "base/or_throw.h"
#include "bus/transport/log_file.h"
#include "rumi/outputs/masks.h"

namespace rumi::tool {

namespace fs = std::filesystem;

std::string map_database_at(const std::string& name) {
  std::error_code error;
  const auto no_map = [&name](const std::string& what) {
    return std::runtime_error(fmt::format(
        "{}: is {}; give the output folder of a run or its map.db (`rumi replay` makes a map of a recording, `rumi "
        "export` a log)",
        name, what));
  };
  if (fs::is_directory(name, error)) {
    const fs::path file = fs::path(name) / "map.db";
    if (!may_be_there(file)) throw no_map("a folder without a map.db");
    return file.string();
  }
  if (fs::is_regular_file(name, error) && is_lcm_log(name)) throw no_map("an lcm log and no map");
  return name;
}

map_server::Atlas load_map(const std::string& file, std::chrono::milliseconds wait) {
  return or_throw(map_server::load_atlas(file, wait));
}

map_server::Atlas load_map_bytes(std::span<const uint8_t> bytes, const std::string& copy_to,
                                 std::string* copy_problem) {
  const TemporaryFolder folder(scratch_folder(fs::path(copy_to).parent_path().string()), "rumi-map-");
  const std::string received = folder.path() + "/map.db";
  WholeFile file(received);
  file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  or_throw(file.commit());
  map_server::MapStore store = or_throw(map_server::MapStore::open(received));
  *copy_problem = store.write_copy(copy_to).error_text();
  return or_throw(store.load());
}

AtlasPicture make_picture(const map_server::Atlas& atlas, const std::string& title) {
  AtlasPicture result;
  result.picture.title = title;
  for (const auto& [key, owner] : atlas.submaps()) {
    const Submap* shown = &owner.submap;
    if (owner.in_map) shown = &(result.placed[key] = map_server::place(owner.submap, owner.placement));
    result.picture.submaps.push_back({shown, owner.in_map});
  }
  for (const auto& [image, frame] : atlas.frames())
    result.picture.frames.push_back(
        {image.utime_us, static_cast<int8_t>(frame.state), {frame.session, frame.submap_id}});
  for (const map_server::Link& link : atlas.links())
    result.picture.links.push_back({link.a, link.b, link.kind == map_server::Link::Kind::kSameImages, link.accepted()});
  return result;
}

std::vector<std::string> write_run_outputs(const map_server::Atlas& atlas, const std::string& folder, int64_t after,
                                           const map_server::LandmarkColours& colours, const cv::Size& image_size) {
  std::vector<std::string> problems = map_server::write_outputs(atlas, folder, after, colours);
  for (const std::string& problem : write_masks(masks_of(atlas, after), folder, image_size))
    problems.push_back(problem);
  return problems;
}

AtlasCounts count(const map_server::Atlas& atlas, int64_t after) {
  AtlasCounts counts;
  std::set<int64_t> earlier_sessions;
  std::set<ImageId> earlier_frames;
  for (const auto& [image, frame] : atlas.frames()) {
    if (frame.session <= after) {
      earlier_sessions.insert(frame.session);
      earlier_frames.insert(image);
      continue;
    }
    const std::optional<map_server::LocatedFrame> located = atlas.locate(image);
    ++counts.frames;
    counts.tracked_frames += located.has_value();
    counts.frames_in_map += located && located->owner->in_map;
  }
  for (const auto& [key, owner] : atlas.submaps()) {
    if (key.session > after) continue;
    earlier_sessions.insert(key.session);
    for (const auto& [utime_us, frame] : owner.submap.frames) earlier_frames.insert({utime_us, owner.submap.stream});
    counts.is_joined = counts.is_joined || (owner.in_map && counts.frames_in_map > 0);
  }
  counts.earlier_sessions = static_cast<int>(earlier_sessions.size());
  counts.earlier_frames = static_cast<int64_t>(earlier_frames.size());
  for (const auto& [key, owner] : atlas.submaps()) {
    if (key.session <= after && !owner.in_map) continue;
    ++counts.submaps;
    counts.keyframes += static_cast<int>(owner.submap.keyframes.size());
    counts.landmarks += static_cast<int>(owner.submap.landmarks.size());
    if (owner.submap.kind != SubmapKind::kFront) continue;
    ++counts.front_submaps;
    counts.front_submaps_in_map += owner.in_map;
  }
  return counts;
}

}  // namespace rumi::tool
