// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/dataset_folder.h"

#include <fmt/format.h>

#include <array>
#include <regex>
#include <vector>

#include "base/files/file_access.h"
#include "formats/recording/file_list.h"
#include "formats/recording/folder_contents.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// True for a folder of colour images beside depth, without lists, as ICL-NUIM offers for TUM's programs.
bool is_colour_beside_depth(const fs::path& folder) {
  return is_folder(folder / "depth") && has_images(folder / "rgb");
}

bool is_dataset(const fs::path& folder) {
  return may_be_there(folder / "rgb.txt") || !find_euroc_list(folder).empty() || is_colour_beside_depth(folder);
}

// Returns the only folder inside; empty if there is none, or several. The one that macOS adds to archives does not
// count.
fs::path only_folder_in(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const std::string name = it->path().filename().string();
    if (is_folder(it->path()) && !name.starts_with('.') && name != "__MACOSX") folders.push_back(it->path());
  }
  return folders.size() == 1 ? folders.front() : fs::path();
}

}  // namespace

fs::path find_euroc_list(const fs::path& folder) {
  for (const char* inner : {"mav0/cam0/data.csv", "cam0/data.csv", "data.csv"})
    if (may_be_there(folder / inner)) return folder / inner;
  return {};
}

DatasetFolder find_dataset(const fs::path& given) {
  DatasetFolder found = {given, ""};
  const bool has_something = is_dataset(given) || has_images(given) || !recordings_in(given).empty();
  if (const fs::path inner = has_something ? fs::path() : only_folder_in(given); !inner.empty() && is_dataset(inner))
    found = {inner, fmt::format("the dataset in its folder {} is played", inner.filename().string())};
  if (!may_be_there(found.folder / "rgb.txt") && !has_images(found.folder) && find_euroc_list(found.folder).empty() &&
      is_colour_beside_depth(found.folder))
    found = {found.folder / "rgb", fmt::format("the images in its folder {} are played",
                                               (found.folder / "rgb").lexically_relative(given).string())};
  return found;
}

std::string advice_on_known_camera(const fs::path& recording, const std::string& channel) {
  struct Known {
    const char *names, *what, *file;
  };
  static constexpr std::array kKnown = {
      Known{"freiburg1", "TUM's freiburg1", "tum_fr1"},
      Known{"freiburg2", "TUM's freiburg2", "tum_fr2"},
      Known{"freiburg3", "TUM's freiburg3", "tum_fr3"},
      Known{"(living|office)_?room.*traj|traj[0-3].*frei", "ICL-NUIM", "icl_nuim"},
      Known{"(MH_0[1-5]|V[12]_0[1-3])_(easy|medium|difficult)", "EuRoC", "euroc_cam0"},
  };
  std::error_code ignored;
  const std::string name = fs::absolute(recording, ignored).string();
  for (const Known& known : kKnown) {
    if (!std::regex_search(name, std::regex(known.names, std::regex::icase))) continue;
    const bool is_right = channel.find("cam1") != std::string::npos && std::string(known.file) == "euroc_cam0";
    return fmt::format("; by its name it is of {}: give --camera config/cameras/{}.yaml (of Rumi)", known.what,
                       is_right ? "euroc_cam1" : known.file);
  }
  return {};
}

}  // namespace rumi
