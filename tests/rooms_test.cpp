// SPDX-License-Identifier: BSD-3-Clause
// Tests which file may include which (docs/architecture.md, "Rooms"). The rules hold for what is built, not for tests
// and benchmarks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace rumi {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

// Folders that a folder may include, besides itself and lcmtypes.
const Names kShared = {"slam", "base", "bus"};
const std::map<std::string, Names> kFolders = {
    {"slam", {}},
    {"base", {}},
    {"bus", {"slam", "base"}},
    {"formats", kShared},
    {"synth", {"slam", "base", "bus", "viewer_offscreen"}},  // draws with the viewer's OpenGL
    {"camera_driver", {"slam", "base", "bus", "formats"}},
    {"front_tracker", kShared},
    {"ruminator", kShared},
    {"map_server", kShared},
    {"viewer_offscreen", kShared},
    {"rumi",
     {"slam", "base", "bus", "formats", "synth", "camera_driver", "front_tracker", "ruminator", "map_server",
      "viewer_offscreen"}},
};

// Rooms that a room may include of its own folder, besides itself; "" is the folder's top. A top that is not listed may
// include all its rooms; a folder that is not listed has no rooms.
const std::map<std::string, std::map<std::string, Names>> kRooms = {
    {"slam",
     {{"numeric", {}},
      {"geometry", {"numeric"}},
      {"features", {"numeric", "geometry"}},
      {"map", {"numeric", "geometry", "features"}},
      {"optimization", {"numeric", "geometry"}}}},
    {"bus",
     {{"transport", {}},
      {"transfer", {"transport"}},
      {"wire", {"transport"}},
      {"process", {"transport", "transfer", "wire"}}}},
    {"camera_driver", {{"source", {}}, {"recording", {"source"}}, {"v4l2", {"source"}}}},
    {"base",
     {{"text", {}},
      {"this_process", {"text"}},
      {"running", {"text", "this_process"}},
      {"memory", {"running", "files"}},
      {"files", {"", "text", "this_process", "running"}},
      {"child", {"", "text", "this_process", "running", "files"}},
      {"command_line", {"text", "this_process", "running", "files"}}}},
    {"formats",
     {{"camera", {}},
      {"image", {}},
      {"times", {}},
      {"recording", {"image", "times"}},
      {"video", {"image", "recording"}},
      {"bag", {"image", "times", "recording"}},
      {"truth", {}},
      {"bag_writer", {"truth"}}}},
    {"front_tracker",
     {{"masking", {}},
      {"frame", {}},
      {"matching", {"frame"}},
      {"patches", {"frame", "matching"}},
      {"initialization", {"frame", "matching", "patches"}},
      {"relocalization", {"frame", "matching", "patches"}},
      {"mapping", {"frame", "matching", "patches"}},
      {"tracking", {"masking", "frame", "matching", "patches", "initialization", "relocalization", "mapping"}}}},
    {"ruminator",
     {{"window", {}},
      {"matching", {}},
      {"model", {"window", "matching"}},
      {"again", {"window", "matching"}},
      {"colmap", {"window", "matching", "model"}},
      {"rebuild", {"window", "matching", "model", "colmap"}},
      {"queue", {"window", "matching", "model", "colmap", "rebuild"}}}},
    {"map_server",
     {{"links", {}},
      {"atlas", {"links"}},
      {"store", {"links", "atlas"}},
      {"alignment", {"links"}},
      {"places", {"links"}},
      {"model", {"links", "atlas", "alignment"}},
      {"outputs", {"links", "atlas", "alignment", "model"}},
      {"merging", {"links", "atlas", "alignment", "places", "model"}}}},
    {"viewer_offscreen",
     {{"gl", {}},
      {"scene", {}},
      {"live", {"scene"}},
      {"canvas", {"gl", "scene"}},
      {"picture", {"gl", "scene", "canvas"}}}},
    {"rumi",
     {{"about", {}},
      {"run", {}},
      {"evaluation", {}},
      {"outputs", {}},
      {"recordings", {}},
      {"calibration", {}},
      {"windows", {"evaluation"}},
      {"report", {"run", "evaluation", "outputs", "calibration", "windows"}},
      {"web", {"run"}},
      {"commands", {"run", "evaluation", "outputs", "recordings", "calibration", "windows", "report", "web"}},
      {"", {"about", "commands"}}}},
};

struct Place {
  std::string folder, room;
};

Place place_of(const fs::path& file) {
  std::vector<std::string> parts;
  for (const fs::path& part : file.parent_path()) parts.push_back(part.string());
  Place place;
  if (!parts.empty()) place.folder = parts[0];
  for (size_t i = 1; i < parts.size(); ++i) place.room += (i > 1 ? "/" : "") + parts[i];
  return place;
}

bool is_room(const Place& place) {
  const auto rooms = kRooms.find(place.folder);
  return place.room.empty() || (rooms != kRooms.end() && rooms->second.contains(place.room));
}

// True if code at the top of a folder includes the readers of calibrations, which a process needs for `--camera FILE`.
bool reads_a_given_camera(const Place& from, const Place& to) {
  return from.room.empty() && to.folder == "formats" && to.room == "camera";
}

bool may_include(const Place& from, const Place& to) {
  if (from.folder != to.folder) return kFolders.at(from.folder).contains(to.folder) || reads_a_given_camera(from, to);
  if (from.room == to.room) return true;
  const auto& rooms = kRooms.at(from.folder);
  const auto allowed = rooms.find(from.room);
  return allowed == rooms.end() || allowed->second.contains(to.room);
}

bool is_source(const fs::path& file) { return file.extension() == ".h" || file.extension() == ".cpp"; }

std::string contents(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// Returns all files that are built, relative to the root.
std::vector<fs::path> sources() {
  const fs::path root = RUMI_SOURCE_DIR;
  std::vector<fs::path> files;
  for (const auto& [folder, allowed] : kFolders)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file() && is_source(entry.path())) files.push_back(fs::relative(entry.path(), root));
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> included_by(const fs::path& file) {
  static const std::regex include("#include \"([^\"]+)\"");
  const std::string text = contents(fs::path(RUMI_SOURCE_DIR) / file);
  std::vector<fs::path> found;
  for (auto i = std::sregex_iterator(text.begin(), text.end(), include); i != std::sregex_iterator(); ++i)
    if (!(*i)[1].str().starts_with("lcmtypes/")) found.emplace_back((*i)[1].str());
  return found;
}

TEST(Rooms, TheOrderIsOne) {
  EXPECT_TRUE(may_include({"slam", "map"}, {"slam", "features"}));
  EXPECT_FALSE(may_include({"slam", "features"}, {"slam", "map"}));
  EXPECT_TRUE(may_include({"map_server", ""}, {"map_server", "merging"}));
  EXPECT_FALSE(may_include({"map_server", "merging"}, {"map_server", ""}));
  EXPECT_FALSE(may_include({"ruminator", "rebuild"}, {"front_tracker", "frame"}));
  EXPECT_TRUE(may_include({"rumi", "run"}, {"ruminator", "queue"}));
  EXPECT_FALSE(is_room({"slam", "cellar"}));
}

TEST(Rooms, EveryFileIsInARoom) {
  const std::vector<fs::path> files = sources();
  ASSERT_GT(files.size(), 400u);
  for (const fs::path& file : files) EXPECT_TRUE(is_room(place_of(file))) << file << " is in a room that is not listed";
}

// Returns the outermost namespace that a file opens, "" if it opens none.
std::string namespace_of(const std::string& text) {
  static const std::regex opened("(?:^|\n)namespace ([a-z_:]+) \\{\n(?!class|struct)");
  std::smatch found;
  return std::regex_search(text, found, opened) ? found[1].str() : "";
}

std::string namespace_for(const std::string& folder) {
  if (folder == "slam" || folder == "base" || folder == "bus" || folder == "formats") return "rumi";
  return "rumi::" + (folder == "rumi" ? "tool" : folder);
}

TEST(Rooms, AComponentIsANamespace) {
  for (const fs::path& file : sources()) {
    const std::string opened = namespace_of(contents(fs::path(RUMI_SOURCE_DIR) / file));
    if (opened.empty()) continue;
    EXPECT_EQ(opened, namespace_for(place_of(file).folder)) << file;
  }
}

// x_test.cpp must be in the folder of tests/ that mirrors the folder of x, if there is exactly one x among the sources.
TEST(Rooms, TestsMirrorThem) {
  std::map<std::string, std::set<fs::path>> folders;  // by folder and stem
  for (const fs::path& file : sources())
    folders[place_of(file).folder + "/" + file.stem().string()].insert(file.parent_path());
  const fs::path tests = fs::path(RUMI_SOURCE_DIR) / "tests";
  int mirrored = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tests)) {
    const std::string name = entry.path().filename().string(), suffix = "_test.cpp";
    if (!name.ends_with(suffix)) continue;
    const fs::path folder = fs::relative(entry.path().parent_path(), tests);
    const std::string stem = name.substr(0, name.size() - suffix.size());
    const auto found = folders.find(folder.begin()->string() + "/" + stem);
    if (found == folders.end() || found->second.size() > 1) continue;
    EXPECT_EQ(folder, *found->second.begin()) << name;
    ++mirrored;
  }
  EXPECT_GT(mirrored, 90);
}

TEST(Rooms, IncludeOnlyWhatStandsBelowThem) {
  for (const fs::path& file : sources())
    for (const fs::path& included : included_by(file)) {
      ASSERT_TRUE(fs::exists(fs::path(RUMI_SOURCE_DIR) / included)) << file << " includes " << included;
      const Place from = place_of(file), to = place_of(included);
      EXPECT_TRUE(may_include(from, to)) << file << " may not include " << included;
    }
}

}  // namespace
}  // namespace rumi
