// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "base/running/log.h"
#include "formats/image/exif.h"
#include "formats/recording/file_list.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

class FileListReader : public FrameReader {
 public:
  FileListReader(FileList list, std::optional<GreyRange> range) : list_(std::move(list)), range_(range) {
    for (const FileList::Entry& entry : list_.entries) utimes_.push_back(entry.utime_us);
  }

  const std::vector<int64_t>& utimes() const override { return utimes_; }
  std::string why_no_times() const override { return list_.why_no_times; }
  std::string where(size_t frame) const override {
    const FileList::Entry& entry = list_.entries[frame];
    if (entry.page != FileList::kWholeFile) return fmt::format("{}: page {}", entry.file.string(), entry.page + 1);
    return entry.line == 0 ? entry.file.string() : fmt::format("{}:{}", list_.source.string(), entry.line);
  }
  fs::path file(size_t frame) const override { return list_.entries[frame].file; }
  fs::path folder() const override {
    std::error_code code;
    return fs::is_directory(list_.source, code) ? list_.source : list_.source.parent_path();
  }
  Result<image_t> load(size_t frame, bool colour) override {
    const auto& [time_us, file, line, page] = list_.entries[frame];
    const auto range_of_all = [this] { return range(); };
    Result<image_t> image = page == FileList::kWholeFile ? load_image_file(file, colour, range_of_all)
                                                         : load_tiff_page(file, page, colour, range_of_all);
    if (!image) return Error{image.error_text(), page == FileList::kWholeFile ? file.string() : where(frame)};
    if (image->pixelformat == image_t::PIXEL_FORMAT_MJPEG) tell_orientation(file, exif_orientation(image->data));
    return image;
  }
  Malformed malformed() const override { return list_.malformed; }
  int64_t missing_at_end() const override { return list_.not_read; }
  std::vector<std::string> notes() const override { return list_.notes; }

 private:
  GreyRange range() {
    if (range_) return *range_;
    range_ = list_.entries.front().page == FileList::kWholeFile ? range_of_files() : range_of_pages();
    tell_grey_range(list_.source.string(), *range_);
    return *range_;
  }

  GreyRange range_of_files() const {
    std::vector<fs::path> files;
    for (const FileList::Entry& entry : list_.entries) files.push_back(entry.file);
    return sample_grey_range(files);
  }
  GreyRange range_of_pages() const {
    GreyHistogram histogram;
    const size_t count = std::min(list_.entries.size(), GreyHistogram::kMostImages);
    for (size_t i = 0; i < count; ++i) {
      const FileList::Entry& entry = list_.entries[i * list_.entries.size() / count];
      histogram.add(grey_pixels_of_page(entry.file, entry.page));
    }
    return histogram.range();
  }

  // Warns of images that should be turned to be shown: they are tracked as they are stored.
  void tell_orientation(const fs::path& file, int orientation) {
    if (orientation != orientation_ && orientation_ != 0 && !is_turn_told_) {
      log_warning(
          "{}: from here on the camera was held another way (EXIF orientation {} instead of {}), which is ignored: the "
          "images are those of another camera, play them by themselves",
          file.string(), orientation, orientation_);
      is_turn_told_ = true;
    } else if (orientation != 1 && orientation_ == 0) {
      log_warning(
          "{}: its EXIF orientation, {}, is ignored: images are played as they are stored, and so must be the "
          "calibration",
          file.string(), orientation);
    }
    orientation_ = orientation;
  }

  FileList list_;
  int orientation_ = 0;  // orientation of the last JPEG; 0: there was none
  bool is_turn_told_ = false;
  std::vector<int64_t> utimes_;
  std::optional<GreyRange> range_;
};

}  // namespace

std::unique_ptr<FrameReader> make_file_list_reader(FileList list, std::optional<GreyRange> grey_range) {
  return std::make_unique<FileListReader>(std::move(list), grey_range);
}

}  // namespace rumi
