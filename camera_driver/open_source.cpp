// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/open_source.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "base/files/file_access.h"
#include "base/running/log.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/recording/recorded_source.h"
#include "camera_driver/v4l2/v4l2_source.h"
#include "formats/bag/bag_file.h"
#include "formats/camera/camera_file.h"
#include "formats/image/tiff_pages.h"
#include "formats/recording/dataset_folder.h"
#include "formats/recording/file_list.h"
#include "formats/recording/folder_contents.h"
#include "formats/recording/foreign_recording.h"
#include "formats/recording/own_output.h"
#include "formats/recording/recording_parts.h"

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;
constexpr const char* kWhatToGive =
    "give a dataset folder (TUM, EuRoC), an image folder, a video, an lcm log or a ROS bag";
constexpr const char* kHowToRecord = "make one with `rumi camera_driver` and lcm-logger";

// Removes a trailing slash, with which parent_path() would return the folder itself.
fs::path without_slash(const std::string& input) {
  const fs::path path = fs::path(input).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

// Returns the first image that can be read. If none can be read, the Error is that of the first image.
Result<image_t> first_readable_image(FrameReader& reader) {
  Result<image_t> first = Error{"has no images"};
  for (size_t i = 0; i < reader.utimes().size(); ++i) {
    Result<image_t> image = reader.load(i, /*colour=*/false);
    if (image) return image;
    if (i == 0) first = std::move(image);
  }
  return first;
}

// Returns the calibration in the metadata of the first readable image of a log or bag, or an empty string.
std::string calibration_in_images(FrameReader& reader) {
  const Result<image_t> image = first_readable_image(reader);
  return image ? std::string(metadata(*image, kCalibrationKey)) : "";
}

// If the file has calibrations for several image sizes, chooses the one for the first readable image.
void choose_size_of_images(FrameReader& reader, CameraFile* calibration) {
  if (calibration->others.empty()) return;
  if (const Result<image_t> image = first_readable_image(reader)) choose_size(image->width, image->height, calibration);
}

Result<CameraFile> find_camera(const CameraOptions& options, const std::vector<fs::path>& candidates,
                               const std::string& input) {
  if (!options.camera_file.empty()) return read_camera_file(options.camera_file);
  for (const fs::path& file : candidates)
    if (may_be_there(file)) return read_camera_file(file.string());
  return Error{"no calibration of the camera", input,
               fmt::format("give --camera FILE or put {} there{}", candidates.front().string(),
                           advice_on_known_camera(input, options.log_channel))};
}

// Returns the image sizes for which the file has a calibration.
std::vector<cv::Size> sizes_of(const Result<CameraFile>& calibration) {
  if (!calibration) return {};
  std::vector<cv::Size> sizes = {{calibration->camera.width, calibration->camera.height}};
  for (const CameraFile::Other& other : calibration->others)
    sizes.emplace_back(other.camera.width, other.camera.height);
  return sizes;
}

// A recording that can be read. Its images can be looked at without a calibration.
struct Recording {
  std::unique_ptr<FrameReader> reader;
  Result<CameraFile> camera;
  std::vector<fs::path> folders = {};  // folders of the recording, in which masks may lie
  std::string note = {};               // warning about files beside the recording, to be logged
};
using Opened = Result<Recording>;

// Returns where masks are looked for: in the recording's folders, and beside a calibration that the user did not give.
MaskPlaces places_of_masks(const CameraFile& camera, const std::vector<fs::path>& folders,
                           const CameraOptions& options) {
  MaskPlaces places{options.mask, camera.mask, folders};
  std::error_code code;
  if (options.camera_file.empty() && fs::is_regular_file(camera.file, code))
    places.folders.push_back(fs::path(camera.file).parent_path());
  return places;
}

Opened from_list(Result<FileList> list, Result<CameraFile> camera, const CameraOptions& options,
                 const std::string& note) {
  if (!list) return list.error();
  if (!note.empty()) list->notes.push_back(note);
  auto reader = make_file_list_reader(std::move(*list), parse_grey_range(options.grey_range));
  const fs::path folder = reader->folder();
  return Recording{std::move(reader), std::move(camera), {folder}};
}

ListOptions list_options(const CameraOptions& options) {
  return {.files = options.files, .needs_times = options.rate_hz <= 0};
}

// Returns " (images are in its folders left, right: give one of them)", or an empty string.
std::string folders_with_images(const fs::path& folder) {
  constexpr size_t kMostNamed = 4;
  std::vector<std::string> names;
  std::error_code code;
  constexpr int kDeepest = 2;  // as deep as "images/front/camera"
  constexpr int kMostLookedAt = 1000;
  int looked_at = 0;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, code);
  for (const fs::recursive_directory_iterator end; !code && it != end; it.increment(code)) {
    std::error_code unreadable;
    if (!it->is_directory(unreadable)) continue;
    if (it.depth() >= kDeepest || ++looked_at > kMostLookedAt) it.disable_recursion_pending();
    if (looked_at <= kMostLookedAt && has_images(it->path()))
      names.push_back(it->path().lexically_relative(folder).string());
  }
  if (names.empty()) return {};
  std::sort(names.begin(), names.end());
  if (names.size() > kMostNamed) names.resize(kMostNamed);
  return fmt::format(" (images are in its folders {}: give one of them)", fmt::join(names, ", "));
}

// Returns the folder of EuRoC's images when their list is missing: their names are their times. Empty if there is no
// such folder.
fs::path find_euroc_images(const fs::path& folder) {
  for (const char* inner : {"mav0/cam0/data", "cam0/data", "data"}) {
    if (has_images(folder / inner)) return folder / inner;
  }
  return {};
}

// Returns " (in it are a.mp4, b.lcm: give the file itself)", or an empty string.
std::string recordings_beside(const fs::path& folder) {
  const std::string recordings = recordings_in(folder);
  return recordings.empty() ? "" : fmt::format(" (in it are {}: give the file itself)", recordings);
}

// Returns " (its files are 12 .gif, which are not read: ...)", or an empty string.
std::string files_not_read(const fs::path& folder) {
  const std::string files = other_files(folder);
  if (files.empty()) return {};
  return fmt::format(
      " (its files are {}; images are read as JPEG, PNG, BMP, TIFF, PGM, PPM or WebP: convert them, as with `mogrify "
      "-format png` of ImageMagick)",
      files);
}

Opened open_folder(const fs::path& given, const CameraOptions& options) {
  const auto [folder, note] = find_dataset(given);
  const std::string name = folder.string();
  const fs::path calibration = folder / "calibration.yaml";
  if (may_be_there(folder / "rgb.txt"))
    return from_list(read_tum_list(folder / "rgb.txt", list_options(options)),
                     find_camera(options, {calibration}, name), options, note);
  if (const fs::path list = find_euroc_list(folder); !list.empty()) {
    const fs::path cam0 = list.parent_path();
    return from_list(read_euroc_list(list, list_options(options)),
                     find_camera(options, {calibration, cam0 / "calibration.yaml", cam0 / "sensor.yaml"}, name),
                     options, note);
  }
  Result<FileList> list = list_image_folder(folder, list_options(options));
  if (list && list->entries.empty())
    if (const fs::path images = find_euroc_images(folder); !images.empty()) {
      list = list_image_folder(images, list_options(options));
      if (list)
        list->notes.push_back("there is no data.csv: its images are played with the times that their names give");
    }
  if (!list) return list.error();
  if (list->entries.empty()) {
    const std::string others = fmt::format("{}{}", folders_with_images(folder), recordings_beside(folder));
    return Error{fmt::format("has no rgb.txt, no mav0/cam0/data.csv and no images{}",
                             others.empty() ? files_not_read(folder) : others),
                 name, kWhatToGive};
  }
  const fs::path images = list->source, above = images.parent_path();
  const fs::path sensor = may_be_there(images / "sensor.yaml") ? images / "sensor.yaml" : above / "sensor.yaml";
  return from_list(
      std::move(list),
      find_camera(options, {calibration, images / "calibration.yaml", above / "calibration.yaml", sensor}, name),
      options, note);
}

// True if the file has a log's name and an event behind the damage. Files with other names are not searched: in a video
// the search would go on to its end.
bool is_log_damaged_at_its_beginning(const fs::path& file) {
  const std::string extension = file.extension().string();
  return (extension == ".lcm" || extension == ".lcmlog" || extension == ".log") && LogReader(file.string()).go_on();
}

bool is_empty_file(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(path, code) && fs::file_size(path, code) == 0;
}

Opened with_camera(const fs::path& file, OpenedReader opened, bool may_bring_calibration,
                   const CameraOptions& options) {
  if (!opened) return opened.error();
  std::unique_ptr<FrameReader> reader = std::move(*opened);
  // The calibration's fps is that of the camera. A video may have another one.
  if (const std::string no_times = reader->why_no_times(); !no_times.empty() && options.rate_hz <= 0)
    return Error{no_times, file.string(), "give --rate HZ"};
  const bool asks_images = may_bring_calibration && options.camera_file.empty();
  const std::string in_images = asks_images ? calibration_in_images(*reader) : "";
  Result<CameraFile> camera = in_images.empty()
                                  ? find_camera(options, {file.parent_path() / "calibration.yaml"}, file.string())
                                  : parse_camera(in_images, file.string() + " (calibration in its images)");
  const std::string why = reader->why_no_calibration();
  if (!why.empty() && camera) camera->notes.push_back(fmt::format("{}; {} is used", why, camera->file));
  if (!why.empty() && !camera) camera = Error{camera.error_text() + "; " + why};
  return Recording{std::move(reader), std::move(camera)};
}

// If the file is a part of a recording, adds a note that the next part is not played.
Opened open_messages(const fs::path& path, OpenedReader opened, const FirstRecorded& first_recorded_us,
                     const CameraOptions& options) {
  const std::optional<int64_t> last_us = opened ? (*opened)->last_recorded_us() : std::nullopt;
  Opened messages = with_camera(path, std::move(opened), /*may_bring_calibration=*/true, options);
  std::error_code code;
  if (messages && last_us && fs::is_regular_file(path, code))
    messages->note = note_on_next_part(path, *last_us, first_recorded_us);
  return messages;
}

Opened open_ros_bag(const fs::path& path, const CameraOptions& options) {
  return open_messages(path, open_bag(path, options.log_channel, parse_grey_range(options.grey_range)),
                       first_recorded_in_bag, options);
}

Opened open_file(const fs::path& file, const CameraOptions& options) {
  if (file.extension() == ".txt" || file.extension() == ".csv")
    return Error{"is a text file", file.string(), "give the folder that it is the list of"};
  if (is_lcm_log(file.string()) || is_log_damaged_at_its_beginning(file))
    return open_messages(file, open_log(file, options.log_channel), first_recorded_in_log, options);
  const Result<CameraFile> camera = find_camera(options, {file.parent_path() / "calibration.yaml"}, file.string());
  // FFmpeg would take it for a video of one image.
  if (pages_of_tiff(file).size() > 1) return from_list(list_pages(file), camera, options, "");
  Opened video = with_camera(file, open_video(file, parse_grey_range(options.grey_range), sizes_of(camera)),
                             /*may_bring_calibration=*/false, options);
  if (video) video->note = note_on_next_video(file);
  return video;
}

Opened open_any(const std::string& input, const CameraOptions& options) {
  const auto refuse = [&input](const std::string& why) { return Error{why, input}; };
  if (is_camera(input)) return refuse(std::string("is a camera, and this needs a recording: ") + kHowToRecord);
  const fs::path path = without_slash(input);
  std::error_code code;
  if (!may_be_there(path))
    if (const std::string advice = advice_on_input(input); !advice.empty()) return refuse(advice);
  if (const std::string why = why_unreadable(path, kWhatToGive); !why.empty()) return refuse(why);
  const fs::file_status status = fs::status(path, code);
  if (const std::string advice = advice_on_foreign_recording(path); !advice.empty()) return refuse(advice);
  if (is_empty_file(path)) return refuse(std::string("is empty; ") + kWhatToGive);
  if (kind_of_bag(path.string()) != BagKind::kNone) return open_ros_bag(path, options);
  if (const std::string advice = advice_on_own_output(path); !advice.empty()) return refuse(advice);
  if (const std::vector<fs::path> parts = parts_in(path); !parts.empty())
    return open_messages(parts.front(), open_log_parts(parts, options.log_channel), first_recorded_in_log, options);
  if (fs::is_directory(status)) return open_folder(path, options);
  if (fs::is_regular_file(status)) return open_file(path, options);
  return refuse(std::string("is not a camera, a file or a folder; ") + kWhatToGive);
}

// Returns the Error for a recording without a usable calibration. If none of its images can be read, the Error says
// that instead: they might have brought a calibration.
Error why_not_playable(const std::string& input, const CameraOptions& options, const Recording& recording) {
  if (!options.camera_file.empty() || recording.reader->utimes().empty()) return recording.camera.error();
  const Result<image_t> image = first_readable_image(*recording.reader);
  if (image) return recording.camera.error();
  return {fmt::format("none of its images can be used: {}", image.error_text()), input};
}

}  // namespace

bool is_camera(const std::string& input) {
  constexpr unsigned kMajorOfVideo = 81;  // Linux's major number of all V4L2 devices, whatever their names
  struct stat info {};
  const bool is_video =
      stat(input.c_str(), &info) == 0 && S_ISCHR(info.st_mode) && major(info.st_rdev) == kMajorOfVideo;
  return names_camera(input) || is_video;
}

OpenedReader open_frames(const std::string& input, const CameraOptions& options) {
  Opened opened = open_any(input, options);
  if (!opened) return opened.error();
  return std::move(opened->reader);
}

OpenedSource open_image_source(const std::string& input, const CameraOptions& options) {
  if (!is_camera(input)) return open_recording(input, options);
  if (const Result<> checked = check(options); !checked) return checked.error();
  return open_camera(kernel_video_system(), input, options);
}

OpenedSource open_recording(const std::string& input, const CameraOptions& options) {
  if (const Result<> checked = check(options); !checked) return checked.error();
  Opened opened = open_any(input, options);
  if (!opened) return opened.error();
  if (!opened->camera) return why_not_playable(input, options, *opened);
  CameraFile& camera = *opened->camera;
  choose_size_of_images(*opened->reader, &camera);
  log_notes(camera);
  if (!opened->note.empty()) log_warning("{}: {}", input, opened->note);
  const MaskPlaces places = places_of_masks(camera, opened->folders, options);
  auto source = std::make_unique<RecordedSource>(input, std::move(opened->reader), camera, options);
  if (const Result<> started = source->start(); !started) return started.error();
  if (const Result<> masks = source->use_masks(places); !masks) return masks.error();
  return OpenedSource(std::move(source));
}

}  // namespace rumi::camera_driver
