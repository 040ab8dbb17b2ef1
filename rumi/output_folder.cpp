// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/output_folder.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>

#include "bus/process.h"
#include "map_server/output_file.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json to_json(const YAML::Node& node) {
  if (node.IsMap()) {
    ordered_json object = ordered_json::object();
    for (const auto& item : node) object[item.first.Scalar()] = to_json(item.second);
    return object;
  }
  // A tag of "!" marks what was quoted: text, whatever it looks like.
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

}  // namespace

ordered_json read_run_json(const std::string& folder) {
  std::ifstream in(fs::path(folder) / "run.json");
  ordered_json run = ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  const bool ours = run.is_object() && run.value("program", ordered_json()) == "rumi";
  return ours ? run : ordered_json();
}

std::string check_output_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    return fmt::format("{}: cannot be made a folder: {}", folder, error ? error.message() : "it is a file");
  }
  const bool empty = fs::is_empty(folder, error);
  if (error) return fmt::format("{}: cannot be read: {}", folder, error.message());
  if (!empty && read_run_json(folder).is_null()) {
    return fmt::format(
        "{}: holds files that are not of an earlier run of rumi (no run.json of ours): "
        "choose another folder, or empty this one",
        folder);
  }
  return "";
}

std::string prepare_output_folder(const std::string& folder) {
  std::string error = check_output_folder(folder);
  return error.empty() ? write_run_json(folder, {{"finished", false}}) : error;
}

std::string write_run_json(const std::string& folder, const ordered_json& run) {
  ordered_json json{{"program", "rumi"}, {"version", version()}};
  json.update(run);
  OutputFile file((fs::path(folder) / "run.json").string());
  file.write(json.dump(2) + "\n");
  return file.commit();
}

ordered_json options_to_json(const std::string& yaml) { return to_json(YAML::Load(yaml)); }

}  // namespace rumi
