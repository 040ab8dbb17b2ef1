// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/colmap_images.h"

#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "base/files/whole_file.h"
#include "base/or_throw.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;

// Groups the images of the map's keyframes by their times.
std::map<int64_t, std::set<ImageId>> images_by_time(const std::vector<ImageId>& images) {
  std::map<int64_t, std::set<ImageId>> by_time;
  for (const ImageId& image : images) by_time[image.utime_us].insert(image);
  return by_time;
}

// Returns the sessions of all submaps. Images that name no stream belong to the stream with the number of their session
// (docs/wire.md).
std::set<int64_t> sessions_of(const map_server::Atlas& atlas) {
  std::set<int64_t> sessions;
  for (const auto& [key, owner] : atlas.submaps()) sessions.insert(key.session);
  return sessions;
}

void write_jpeg(const image_t& image, const fs::path& file) {
  const Result<cv::Mat> bgr = decode_bgr(image);
  std::vector<uint8_t> jpeg;
  if (!bgr || !cv::imencode(".jpg", *bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality}))
    throw std::runtime_error(file.string() + ": cannot be made: " + bgr.error_text());
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  WholeFile out(file.string());
  out.write({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  or_throw(out.commit());
}

}  // namespace

ColmapImages find_colmap_images(const map_server::Atlas& atlas, camera_driver::ImageSource& recording,
                                const std::string& folder) {
  ColmapImages found;
  const std::vector<ImageId> images = map_server::colmap_images(atlas);
  const auto by_time = images_by_time(images);
  const std::set<int64_t> sessions = sessions_of(atlas);
  found.keyframes = static_cast<int64_t>(images.size());
  found.folder = recording.image_folder().string();
  found.are_written = found.folder.empty();
  if (found.are_written) found.folder = (fs::path(folder) / "images").string();
  std::set<int64_t> utimes_us;
  for (const auto& [utime_us, same_time] : by_time) utimes_us.insert(utime_us);
  recording.play_again(utimes_us, camera_driver::ImageSource::Pixels::kColour);
  while (const std::optional<image_t> image = recording.next()) {
    for (const ImageId& id : by_time.at(image->utime)) {
      if (id.stream != stream_of(*image) && !sessions.contains(id.stream)) continue;
      map_server::ImageFile& file = found.files[id];
      file = {map_server::colmap_name(id, images), image->width, image->height};
      if (found.are_written)
        write_jpeg(*image, fs::path(found.folder) / file.name);
      else
        file.name = recording.file_of_last().lexically_relative(found.folder).string();
    }
  }
  return found;
}

}  // namespace rumi::tool
