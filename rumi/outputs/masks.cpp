// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/masks.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string_view>

#include "base/files/whole_file.h"
#include "bus/wire/image_masks.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

std::string file_of(const RunMasks& masks, int64_t stream) {
  return masks.size() == 1 ? "mask.png" : fmt::format("mask-{}.png", stream);
}

// Returns, for example, "17 %" or "0.8 %".
std::string percent(double share) {
  constexpr double kFewPercent = 10;
  return fmt::format("{:.{}f} %", 100 * share, 100 * share < kFewPercent ? 1 : 0);
}

// True if the mask may be of images of this size. Large images are tracked at a smaller size of the same shape.
bool may_be_of(const cv::Size& size, const map_server::StillMask& mask) {
  const double scale = static_cast<double>(size.width) / mask.width;
  return !size.empty() && std::abs(scale * mask.height - size.height) <= std::max(1.0, scale);
}

Result<> write_mask(const map_server::StillMask& mask, const cv::Size& image_size, const std::string& name) {
  const Result<cv::Mat> pixels = decode_mask(mask.png);
  if (!pixels) return Error{pixels.error().text(), name};
  WholeFile file(name);
  file.write(may_be_of(image_size, mask) ? encode_mask(ImageMask(*pixels).resized(image_size).pixels()) : mask.png);
  return file.commit();
}

void remove_masks(const fs::path& folder) {
  std::vector<fs::path> old;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (is_mask_name(it->path().filename().string())) old.push_back(it->path());
  for (const fs::path& file : old) fs::remove(file, error);
}

}  // namespace

RunMasks masks_of(const map_server::Atlas& atlas, int64_t after) {
  RunMasks masks;
  for (const auto& [stream, mask] : atlas.masks())
    if (mask.session > after && mask.left_out > 0) masks[stream] = mask;
  return masks;
}

std::vector<std::string> describe_masks(const RunMasks& masks) {
  std::vector<std::string> lines;
  for (const auto& [stream, mask] : masks)
    lines.push_back(fmt::format("{} of the image{} never moves (bonnet or caption): left out, {} shows it",
                                percent(mask.left_out), masks.size() == 1 ? "" : fmt::format(" of stream {}", stream),
                                file_of(masks, stream)));
  return lines;
}

nlohmann::ordered_json masks_to_json(const RunMasks& masks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [stream, mask] : masks)
    json.push_back({{"stream", stream},
                    {"session", mask.session},
                    {"utime", mask.utime_us},
                    {"width", mask.width},
                    {"height", mask.height},
                    {"left_out", mask.left_out},
                    {"file", file_of(masks, stream)}});
  return json;
}

std::vector<std::string> write_masks(const RunMasks& masks, const std::string& folder, const cv::Size& image_size) {
  remove_masks(folder);
  std::vector<std::string> problems;
  for (const auto& [stream, mask] : masks)
    if (const Result<> written = write_mask(mask, image_size, (fs::path(folder) / file_of(masks, stream)).string());
        !written)
      problems.push_back(written.error().text());
  return problems;
}

bool is_mask_name(const std::string& name) {
  constexpr std::string_view kBegin = "mask-", kEnd = ".png";
  if (name == "mask.png") return true;
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd) || name.size() <= kBegin.size() + kEnd.size()) return false;
  const std::string_view number =
      std::string_view(name).substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

Result<> check_mask_stays(const std::string& given, const std::string& input, const std::string& folder) {
  std::error_code none;
  const fs::path beside = fs::is_directory(input, none) ? fs::path(input) : fs::path(input).parent_path();
  const std::string mask = given.empty() ? (beside / "mask.png").string() : given;
  if ((given.empty() && input.empty()) || !fs::exists(mask, none)) return {};
  const fs::path file = fs::weakly_canonical(mask, none);
  if (!is_mask_name(file.filename().string()) || file.parent_path() != fs::weakly_canonical(folder, none)) return {};
  return Error{"is what the run itself writes: give the mask another name, or the run another folder", mask};
}

}  // namespace rumi::tool
