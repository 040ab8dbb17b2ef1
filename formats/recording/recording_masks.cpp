// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/recording_masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/running/log.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/mask_file.h"
#include "formats/image/library_messages.h"
#include "formats/recording/folder_contents.h"
#include "formats/recording/mask_option.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaskName = "mask.png";
constexpr const char* kFolderName = "masks";

// Knows which files exist. Each folder is read once: a recording may have many thousand images, and no masks.
class Files {
 public:
  bool has(const fs::path& file) {
    const auto [found, is_new] = names_.try_emplace(file.parent_path());
    if (is_new) {
      std::error_code code;
      for (fs::directory_iterator it(file.parent_path(), code), end; !code && it != end; it.increment(code))
        found->second.insert(it->path().filename().string());
    }
    return found->second.contains(file.filename().string());
  }

 private:
  std::map<fs::path, std::set<std::string>> names_;
};

bool is_folder(const fs::path& path) {
  std::error_code code;
  return fs::is_directory(path, code);
}

// Returns the names that the mask of an image may have: COLMAP's, a.jpg.png for a.jpg, then a.png; each with the
// image's path in the list, and without.
std::vector<fs::path> names_of_mask(const fs::path& folder, const fs::path& image, const fs::path& root) {
  const fs::path path = image.lexically_proximate(root);
  std::vector<fs::path> names;
  for (const fs::path& name : {path, path.filename()}) {
    names.push_back(folder / (name.string() + ".png"));
    names.push_back(folder / fs::path(name).replace_extension(".png"));
  }
  return names;
}

fs::path beside(const fs::path& image) { return image.string() + ".png"; }

}  // namespace

bool is_mask_name(const std::string& name, const std::vector<std::string>& beside) {
  if (name == kMaskName) return true;
  const fs::path image = fs::path(name).stem();
  return fs::path(name).extension() == ".png" && is_image_name(image) &&
         std::binary_search(beside.begin(), beside.end(), image.string());
}

bool RecordingMasks::has_found() const {
  return std::any_of(of_frames_.begin(), of_frames_.end(), [](const fs::path& file) { return !file.empty(); });
}

Result<> RecordingMasks::use_for_all(const std::string& file) {
  const DecoderMessages are_ours;
  const Result<cv::Mat> mask = read_camera_mask(file, size_);
  if (!mask) return mask.error();
  of_all_ = *mask;
  png_of_all_ = encode_mask(of_all_);
  what_ = fmt::format("{}: {:.1f} % of each image is left out", file, 100 * share_left_out(*mask));
  return {};
}

// Fills of_frames_ with files of the folder, or, if `folder` is empty, with files beside the images. Returns the names
// that were looked for first.
std::string RecordingMasks::find_of_frames(const fs::path& folder, const FrameReader& reader) {
  Files files;
  std::string first;
  of_frames_.assign(reader.utimes().size(), {});
  for (size_t i = 0; i < of_frames_.size(); ++i) {
    const fs::path image = reader.file(i);
    if (image.empty()) continue;
    const std::vector<fs::path> names =
        folder.empty() ? std::vector{beside(image)} : names_of_mask(folder, image, reader.folder());
    if (first.empty())
      first = folder.empty() ? names[0].string() : fmt::format("{} or {}", names[0].string(), names[1].string());
    const auto found = std::find_if(names.begin(), names.end(), [&](const fs::path& name) { return files.has(name); });
    if (found != names.end()) of_frames_[i] = *found;
  }
  return first;
}

Result<> RecordingMasks::check_of_frames() {
  int64_t count = 0;
  fs::path first;
  for (const fs::path& file : of_frames_) {
    if (file.empty()) continue;
    if (const Result<> checked = check_mask_file(file.string(), size_); !checked) return checked;
    if (++count == 1) first = file;
  }
  what_ += fmt::format("{}{} of {} images have a mask of their own (the first: {})", what_.empty() ? "" : "; ", count,
                       of_frames_.size(), first.string());
  return {};
}

Result<> RecordingMasks::find(const MaskPlaces& places, const FrameReader& reader, const cv::Size& size) {
  size_ = size;
  if (places.given == kNoMask) return {};
  if (is_folder(places.given)) {
    const std::string looked_for = find_of_frames(places.given, reader);
    if (looked_for.empty())
      return Error{"is a folder, and only images in files of their own can have a mask each: give one PNG",
                   places.given};
    if (!has_found()) return Error{"has no mask of any image: looked for " + looked_for, places.given};
    return check_of_frames();
  }
  if (!places.given.empty()) return use_for_all(places.given);
  std::string for_all = places.of_calibration;
  for (const fs::path& folder : places.folders) {
    std::error_code code;
    if (for_all.empty() && fs::exists(folder / kMaskName, code)) for_all = (folder / kMaskName).string();
    if (!has_found() && is_folder(folder / kFolderName)) find_of_frames(folder / kFolderName, reader);
  }
  if (!has_found()) find_of_frames("", reader);
  if (!for_all.empty())
    if (const Result<> used = use_for_all(for_all); !used) return used;
  return has_found() ? check_of_frames() : Result<>();
}

std::string RecordingMasks::png_of(size_t frame) {
  if (frame >= of_frames_.size() || of_frames_[frame].empty()) return png_of_all_;
  const DecoderMessages are_ours;
  const Result<cv::Mat> own = read_mask_file(of_frames_[frame].string(), size_);
  if (own) return encode_mask(of_all_.empty() ? *own : cv::Mat(*own & of_all_));
  if (!is_problem_told_) log_warning("{}; the image is used without it (more of them are not told)", own.error_text());
  is_problem_told_ = true;
  return png_of_all_;
}

}  // namespace rumi
