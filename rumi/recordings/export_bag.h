// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "formats/bag_writer/bag_writer.h"
#include "formats/truth/trajectory.h"
#include "rumi/recordings/image_sink.h"
#include "slam/geometry/camera.h"

namespace rumi::tool {

// Writes a bag of ROS: the images and their camera_info, the camera's poses in the map on /rumi/pose and as /tf, and
// all poses at once on /rumi/path.
class BagSink : public ImageSink {
 public:
  // True if the name ends in .mcap or .bag.
  static bool takes(const std::string& file);
  // `topic`: topic of the images, without "/compressed", which is appended for JPEGs. `poses`: sorted by time; may be
  // empty.
  BagSink(const std::string& file, std::string topic, std::vector<TimedPose> poses);
  bool write(const image_t& image) override;
  std::string close() override;
  std::string content() const override;

 private:
  void write_poses_until(int64_t utime_us);
  bool take_camera(const image_t& image);

  std::string file_, topic_;
  std::vector<TimedPose> poses_;
  std::unique_ptr<BagWriter> bag_;
  std::string problem_;
  std::string images_topic_, images_type_;  // empty before the first image
  int64_t first_us_ = 0, last_us_ = 0;
  std::string calibration_;  // calibration of the last image
  std::optional<Camera> camera_;
  size_t next_pose_ = 0;
};

}  // namespace rumi::tool
