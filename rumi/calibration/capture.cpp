// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/capture.h"

#include <fmt/format.h>

#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"

namespace rumi::tool {

Result<> collect_from_recording(const std::string& input, const std::string& log_channel, int every,
                                const std::function<bool()>& go_on, ViewCollector* collector) {
  if (camera_driver::is_camera(input))
    return Error{
        fmt::format(
            "is a camera: start `rumi camera_driver '{}'` in another terminal, and `rumi calibrate` without SOURCE",
            input),
        input};
  camera_driver::CameraOptions options;
  options.log_channel = log_channel;
  options.rate_hz = 1;  // makes up the times of images that have none; they are not used
  const OpenedReader opened = camera_driver::open_frames(input, options);
  if (!opened) return opened.error();
  FrameReader& reader = **opened;
  for (size_t frame = 0; frame < reader.utimes().size(); frame += static_cast<size_t>(every)) {
    Result<image_t> image = reader.load(frame, /*colour=*/false);
    if (!image) {
      collector->add_unreadable(image.error_text());
    } else {
      image->utime = reader.utimes()[frame];
      if (!collector->add(*image, reader.where(frame))) return Error{collector->problem()};
    }
    if (!go_on()) break;
  }
  return {};
}

void collect_from_bus(Bus& bus, ViewCollector* collector) {
  bus.subscribe<image_t>(channels::kCamera, {1, DropPolicy::kDropOldest}, [collector](const image_t& image) {
    if (collector->problem().empty()) collector->add(image, fmt::format("image {}", image.utime));
  });
}

}  // namespace rumi::tool
