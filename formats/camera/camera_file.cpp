// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/camera_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/files/file_access.h"
#include "base/running/log.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_fold.h"
#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxListBytes = 4 << 20;  // largest file that is read: lists of cameras are longer than our YAML

constexpr const char* kExpected =
    "expected our YAML (fx: 525 ... width: 640, see config/cameras), or a file of a tool that docs/calibration.md "
    "names";

Result<FileCameras> read_text(const std::string& text, const std::string& name) {
  if (const std::string stranger = known_stranger(text); !stranger.empty()) return Error{stranger, name};
  const Result<Fields> fields = fields_of_text(text, name, kExpected);
  if (!fields) return fields.error();
  return read_fields(*fields);
}

// Returns the camera; an Error if it cannot be used, or its numbers make no sense.
Result<Camera> usable(const FileCamera& read, const std::string& file) {
  if (!read.camera) return read.camera;
  const Result<> checked = check_calibration(*read.camera);
  if (!checked) return Error{checked.error_text(), read.name.empty() ? file : file + ", " + read.name};
  return read.camera;
}

std::vector<std::string> lenses_of(const FileCameras& all) {
  std::vector<std::string> lenses;
  for (const FileCamera& camera : all.cameras)
    if (std::find(lenses.begin(), lenses.end(), camera.lens) == lenses.end()) lenses.push_back(camera.lens);
  return lenses;
}

// Names only the first lenses: COLMAP's file may have a camera for each image.
std::string in_short(const std::vector<std::string>& lenses) {
  constexpr size_t kMostNamed = 8;
  const size_t named = std::min(lenses.size(), kMostNamed);
  const std::string more = lenses.size() > named ? fmt::format(" and {} more", lenses.size() - named) : "";
  return fmt::format("{}{}", fmt::join(lenses.begin(), lenses.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                     more);
}

// Finds the camera of this name or lens (any case), the default camera if `choice` is empty. An Error if the file does
// not have it.
Result<FileCamera> find_camera(const FileCameras& all, const std::string& file, const std::string& choice) {
  const auto is_meant = [&choice](const FileCamera& camera) {
    const std::string wanted = lower_case(choice);
    return wanted.empty() || lower_case(camera.name) == wanted || lower_case(camera.lens) == wanted;
  };
  const auto chosen = std::find_if(all.cameras.begin(), all.cameras.end(), is_meant);
  if (chosen != all.cameras.end()) return *chosen;
  const std::vector<std::string> lenses = lenses_of(all);
  if (lenses.size() < 2) return Error{fmt::format("has one camera only: give it without ':{}'", choice), file};
  return Error{fmt::format("has no camera '{}': it has {}", choice, in_short(lenses)), file};
}

Result<CameraFile> choose(const FileCameras& all, const std::string& file, const std::string& choice) {
  const Result<FileCamera> chosen = find_camera(all, file, choice);
  if (!chosen) return chosen.error();
  const std::vector<std::string> lenses = lenses_of(all);
  const bool is_default_of_several = choice.empty() && lenses.size() > 1;
  const Result<Camera> camera = usable(*chosen, file);
  if (!camera && is_default_of_several)
    return Error{camera.error_text() + fmt::format(" (or name another camera of the file, {}, as in {}:{})",
                                                   in_short(lenses), file, lenses[1])};
  if (!camera) return camera.error();
  CameraFile result;
  result.camera = *camera, result.format = all.format, result.file = file;
  result.name = chosen->name, result.lens = chosen->lens, result.notes = chosen->notes;
  if (!chosen->mask.empty()) result.mask = (fs::path(file).parent_path() / chosen->mask).string();
  if (const Fold fold = fold_of(*camera); !fold.text.empty())
    result.notes.push_back(fmt::format("{}: {}", file, fold.text));
  for (const FileCamera& other : all.cameras)
    if (const Result<Camera> its = usable(other, file); its && other.name != chosen->name)
      result.others.push_back({other.name, other.lens, *its});
  if (is_default_of_several)
    result.notes.push_back(fmt::format("{}: has {} cameras ({}): {} is taken; {}:{} would name another", file,
                                       lenses.size(), in_short(lenses), chosen->lens, file, lenses[1]));
  return result;
}

// Reads the text of a file. It may be longer than our YAML, and in formats that texts from the network may not have.
Result<FileCameras> read_file_text(const std::string& text, const std::string& name) {
  try {
    if (is_realsense_listing(text)) return read_realsense(text, name);
    if (is_nerf_list(text)) return read_nerf_list(text, name);
    if (is_colmap_list(text)) return read_colmap(text, name);
  } catch (const YAML::Exception& e) {  // these readers turn lines into YAML
    return Error{fmt::format("cannot be read ({}): {}", e.msg, kExpected), name};
  }
  const std::string yaml = text.size() <= kMaxYamlBytes ? yaml_of_opencv_xml(text) : "";
  return read_text(yaml.empty() ? text : yaml, name);
}

Result<std::string> text_of(const std::string& file) {
  const std::string why = why_unreadable(file, "give the camera's calibration with --camera FILE");
  if (!why.empty()) return Error{why, file};
  std::error_code code;
  if (fs::is_directory(file, code)) return Error{"is a folder", file, "give the calibration file in it"};
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = fs::file_size(file, code);  // fails for a pipe
  std::string text(code ? kMaxListBytes : std::min<std::uintmax_t>(size, kMaxListBytes) + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  if (!stream.is_open() || stream.bad()) return Error{"cannot be read", file, "is the disk in order?"};
  return text;
}

Result<CameraFile> read_chosen(const std::string& file, const std::string& choice) {
  const Result<std::string> text = text_of(file);
  if (!text) return text.error();
  const Result<FileCameras> all = read_file_text(*text, file);
  if (!all) return all.error();
  return choose(*all, file, choice);
}

}  // namespace

Result<CameraFile> parse_camera(const std::string& text, const std::string& name) {
  const Result<FileCameras> all = read_text(text, name);
  if (!all) return all.error();
  Result<CameraFile> result = choose(*all, name, "");
  if (result) result->mask.clear();  // a text from the network must not name files of this computer
  return result;
}

Result<CameraFile> read_camera_file(const std::string& file) {
  std::error_code code;
  const size_t colon = file.rfind(':');
  const bool names_camera = colon != std::string::npos && colon + 1 < file.size() && !fs::exists(file, code) &&
                            fs::is_regular_file(file.substr(0, colon), code);
  return names_camera ? read_chosen(file.substr(0, colon), file.substr(colon + 1)) : read_chosen(file, "");
}

void choose_size(int width, int height, CameraFile* result) {
  if (result->camera.width == width && result->camera.height == height) return;
  for (CameraFile::Other& other : result->others) {
    if (other.lens != result->lens || other.camera.width != width || other.camera.height != height) continue;
    std::swap(other.name, result->name);
    std::swap(other.camera, result->camera);
    return;
  }
}

std::string advice_on_size(const CameraFile& calibration, int width, int height) {
  for (const CameraFile::Other& other : calibration.others)
    if (other.camera.width == width && other.camera.height == height)
      return fmt::format("{} of the same file is for this size: if it is this camera, give --camera {}:{}", other.name,
                         calibration.file, other.lens);
  const Camera& camera = calibration.camera;
  if (camera.width == height && camera.height == width)
    return "the images are turned by 90 degrees: turn them back, or calibrate with images as they are now";
  if (camera.width * static_cast<int64_t>(height) != camera.height * static_cast<int64_t>(width))
    return "their shape differs, too, so they show another part of the sensor: give the calibration of this camera and "
           "size (--camera FILE)";
  const Camera c = camera.resized(width, height);
  return fmt::format(
      "give the calibration of this camera and size (--camera FILE); if these are the calibrated images made {}, that "
      "is "
      "the same with fx: {:.6g}, fy: {:.6g}, cx: {:.6g}, cy: {:.6g}, width: {}, height: {}",
      width < camera.width ? "smaller" : "larger", c.fx, c.fy, c.cx, c.cy, width, height);
}

void log_notes(const CameraFile& result) {
  for (const std::string& note : result.notes) log_warning("{}", note);
  if (result.name != result.lens) log_info("{}: its camera {} is taken", result.file, result.name);
}

}  // namespace rumi
