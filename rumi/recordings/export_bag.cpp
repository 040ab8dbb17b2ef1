// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/export_bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "formats/bag_writer/ros_message.h"

namespace rumi::tool {
namespace {

constexpr const char *kPoseTopic = "/rumi/pose", *kPathTopic = "/rumi/path", *kTransformsTopic = "/tf";
constexpr int64_t kNanoseconds = 1000;  // in a microsecond

std::string extension_of(const std::string& file) { return std::filesystem::path(file).extension().string(); }

std::string info_topic(const std::string& images) { return images.substr(0, images.rfind('/')) + "/camera_info"; }

}  // namespace

bool BagSink::takes(const std::string& file) { return extension_of(file) == ".mcap" || extension_of(file) == ".bag"; }

BagSink::BagSink(const std::string& file, std::string topic, std::vector<TimedPose> poses)
    : file_(file),
      topic_(topic.starts_with('/') ? std::move(topic) : "/" + topic),
      poses_(std::move(poses)),
      bag_(extension_of(file) == ".bag" ? write_ros1_bag(file) : write_mcap_file(file)) {}

bool BagSink::write(const image_t& image) {
  const std::string type = type_of(image);
  if (images_type_.empty()) {
    images_type_ = type;
    images_topic_ = topic_ + (type == kCompressedImageType ? "/compressed" : "");
    first_us_ = image.utime;
    if (!poses_.empty())
      bag_->write(kPathTopic, kPathType, image.utime * kNanoseconds, path_message(poses_, bag_->ros()));
  }
  if (type != images_type_)
    problem_ = fmt::format(
        "{}: the recording has JPEG images and others, which would be of two topics: give --encoding grey, rgb or jpeg",
        file_);
  if (!problem_.empty() || !take_camera(image) || !bag_->so_far()) return false;
  write_poses_until(image.utime);
  const int64_t time_ns = image.utime * kNanoseconds;
  bag_->write(info_topic(topic_), kCameraInfoType, time_ns, camera_info_message(*camera_, image.utime, bag_->ros()));
  bag_->write(images_topic_, type, time_ns, image_message(image, bag_->ros()));
  last_us_ = image.utime;
  return true;
}

bool BagSink::take_camera(const image_t& image) {
  std::string calibration(metadata(image, kCalibrationKey));
  if (camera_ && calibration == calibration_) return true;
  const Result<Calibration> parsed = parse_calibration(calibration, "calibration of the image");
  if (!parsed) problem_ = fmt::format("{}: {}", file_, parsed.error_text());
  calibration_ = std::move(calibration);
  camera_ = parsed ? parsed->camera : Camera();
  return parsed.has_value();
}

void BagSink::write_poses_until(int64_t utime_us) {
  for (; next_pose_ < poses_.size() && poses_[next_pose_].utime_us <= utime_us; ++next_pose_) {
    const TimedPose& pose = poses_[next_pose_];
    const int64_t time_ns = pose.utime_us * kNanoseconds;
    bag_->write(kTransformsTopic, kTransformsType, time_ns, transforms_message(pose, bag_->ros()));
    bag_->write(kPoseTopic, kPoseType, time_ns, pose_message(pose, bag_->ros()));
  }
}

std::string BagSink::close() {
  if (!problem_.empty()) return problem_;
  const bool are_of_it = std::any_of(poses_.begin(), poses_.end(), [this](const TimedPose& pose) {
    return pose.utime_us >= first_us_ && pose.utime_us <= last_us_;
  });
  if (!poses_.empty() && !are_of_it)
    return fmt::format(
        "none of the {} poses has a time among those of the images ({:.3f} to {:.3f} s): give the run, or the poses, "
        "of this recording",
        poses_.size(), static_cast<double>(first_us_) * 1e-6, static_cast<double>(last_us_) * 1e-6);
  write_poses_until(std::numeric_limits<int64_t>::max());
  return bag_->close().error_text();
}

std::string BagSink::content() const {
  const std::string images = fmt::format("images on {}", images_topic_.empty() ? topic_ : images_topic_);
  if (poses_.empty()) return images;
  return fmt::format("{}, {} poses on {}, {} and {}", images, poses_.size(), kTransformsTopic, kPoseTopic, kPathTopic);
}

}  // namespace rumi::tool
