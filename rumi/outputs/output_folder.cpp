// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/output_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <vector>

#include "base/files/whole_file.h"
#include "base/text/json_text.h"
#include "base/this_process/process_name.h"
#include "bus/process/process.h"
#include "map_server/store/map_store.h"
#include "rumi/outputs/masks.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json to_json(const YAML::Node& node) {
  if (node.IsMap()) {
    ordered_json object = ordered_json::object();
    for (const auto& item : node) object[item.first.Scalar()] = to_json(item.second);
    return object;
  }
  // A tag of "!" marks a quoted value, which is text whatever it looks like.
  int integer = 0;
  double real = 0;
  bool truth = false;
  if (node.Tag() != "!") {
    if (YAML::convert<int>::decode(node, integer)) return integer;
    if (YAML::convert<double>::decode(node, real)) return real;
    if (YAML::convert<bool>::decode(node, truth)) return truth;
  }
  return node.IsScalar() ? node.Scalar() : "";
}

bool is_number(std::string_view text, size_t min_digits) {
  return text.size() >= min_digits && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// True for names of submaps: 001, b001, s1700000000000000-001 (output_files.h).
bool is_submap_name(std::string_view stem) {
  if (const size_t dash = stem.rfind('-'); dash != std::string_view::npos) {
    std::string_view session = stem.substr(0, dash);
    if (!session.starts_with('s')) return false;
    session.remove_prefix(session.starts_with("s-") ? 2 : 1);
    if (!is_number(session, 1)) return false;
    stem.remove_prefix(dash + 1);
  }
  if (stem.starts_with('b')) stem.remove_prefix(1);
  return is_number(stem, 3);
}

// True if a run writes a file of this name (relative to its folder), or removes it as left over from an earlier run.
bool is_written_by_a_run(const fs::path& name) {
  static const std::set<std::string> kNames = {"run.json",       "trajectory.txt", "trajectory.png",
                                               "trajectory.mp4", "frames.csv",     "map.db",
                                               "map.ply",        "windows.csv",    "pictures/unfinished"};
  const std::string folder = name.parent_path().string(), extension = name.extension().string();
  return kNames.contains(name.string()) || is_mask_name(name.string()) ||
         (folder == "windows" && extension == ".window") ||
         (folder == "submaps" && extension == ".txt" && is_submap_name(name.stem().string())) ||
         (folder == "pictures" && extension == ".png" && is_number(name.stem().string(), 6));
}

std::vector<std::string> what_a_run_replaces(const fs::path& folder, std::error_code* error) {
  std::vector<std::string> names;
  for (const fs::path& below : {folder, folder / "submaps", folder / "windows", folder / "pictures"}) {
    if (!fs::exists(below)) continue;
    for (fs::directory_iterator it(below, *error), end; !*error && it != end; it.increment(*error)) {
      const std::string name = it->path().lexically_relative(folder).string();
      if (is_written_by_a_run(name)) names.push_back(name);
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Returns, for example, "a, b, c and 7 more".
std::string list(const std::vector<std::string>& names) {
  constexpr size_t kShown = 3;
  const auto end = names.begin() + static_cast<ptrdiff_t>(std::min(names.size(), kShown));
  const std::string text = fmt::format("{}", fmt::join(names.begin(), end, ", "));
  return names.size() <= kShown ? text : fmt::format("{} and {} more", text, names.size() - kShown);
}

}  // namespace

ordered_json read_run_json(const std::string& folder) {
  std::ifstream in(fs::path(folder) / "run.json");
  ordered_json run = ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  const bool ours = run.is_object() && run.value("program", ordered_json()) == "rumi";
  return ours ? run : ordered_json();
}

Result<> check_output_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    std::error_code ignored;
    const bool is_file = fs::exists(folder, ignored) && !fs::is_directory(folder, ignored);
    if (is_file) return Error{"cannot be made a folder: it is a file", folder, "give another name"};
    return Error{"cannot be made a folder: " + error.message(), folder};
  }
  // The map in this folder may be in use by a map_server.
  const std::string database = (fs::path(folder) / "map.db").string();
  if (fs::exists(map_server::DatabaseLock::file_of(database), error)) {
    if (const auto free = map_server::DatabaseLock::take(database); !free) return Error{free.error().text(), folder};
  }
  if (!read_run_json(folder).is_null()) return {};
  const std::vector<std::string> foreign = what_a_run_replaces(folder, &error);
  if (error) return Error{"cannot be read: " + error.message(), folder};
  if (foreign.empty()) return {};
  return Error{fmt::format("{} would be overwritten, and {} not of an earlier run of rumi (no run.json of ours): "
                           "choose another folder, or move {} away",
                           list(foreign), foreign.size() == 1 ? "is" : "are", foreign.size() == 1 ? "it" : "them"),
               folder};
}

Result<> prepare_output_folder(const std::string& folder) {
  if (const Result<> usable = check_output_folder(folder); !usable) return usable;
  std::error_code is_absent;
  if (!read_run_json(folder).is_null())
    fs::remove(fs::path(folder) / "report.html", is_absent);  // left by an earlier run
  return write_run_json(folder, {{"finished", false}});
}

Result<> check_map_stays(const std::string& database, const std::string& folder) {
  std::error_code none;
  const fs::path output = fs::path(folder) / "map.db";
  if (fs::weakly_canonical(database, none) != fs::weakly_canonical(output, none)) return {};
  return Error{
      "is the map of map_server.database, and the map of the outputs would replace it: choose another folder than " +
          folder,
      output.string()};
}

Result<> write_run_json(const std::string& folder, const ordered_json& run) {
  ordered_json json{{"program", "rumi"}, {"version", version()}};
  json.update(run);
  WholeFile file((fs::path(folder) / "run.json").string());
  file.write(json_text(json, 2) + "\n");
  return file.commit();
}

ordered_json options_to_json(const std::string& yaml) { return to_json(YAML::Load(yaml)); }

}  // namespace rumi::tool
