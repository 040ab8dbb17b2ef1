// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag_writer/ros_message.h"

#include <bit>
#include <initializer_list>

#include "formats/bag_writer/put_bytes.h"

namespace rumi {
namespace {

class MessageWriter {
 public:
  explicit MessageWriter(Ros ros) : is_cdr_(ros == Ros::k2) {
    if (is_cdr_) bytes_ = std::string("\0\1\0\0", kPreambleBytes);  // little endian
  }
  template <class Number>
  void number(Number value) {
    // CDR aligns each number to its size, counted from the end of the preamble.
    while (is_cdr_ && (bytes_.size() - kPreambleBytes) % sizeof(Number) != 0) bytes_ += '\0';
    put(value, &bytes_);
  }
  void count(size_t value) { number(static_cast<uint32_t>(value)); }
  void real(double value) { number(std::bit_cast<uint64_t>(value)); }
  void reals(std::initializer_list<double> values) {
    for (const double value : values) real(value);
  }
  void text(const std::string& text) {
    count(text.size() + (is_cdr_ ? 1 : 0));
    bytes_ += text;
    if (is_cdr_) bytes_ += '\0';
  }
  void data(const std::vector<uint8_t>& data) {
    count(data.size());
    bytes_.append(data.begin(), data.end());
  }
  void header(int64_t utime_us, const char* frame) {
    if (!is_cdr_) count(0);  // seq
    constexpr int64_t kPerSecond = 1'000'000, kNanoseconds = 1000;
    number(static_cast<uint32_t>(utime_us / kPerSecond));
    number(static_cast<uint32_t>(utime_us % kPerSecond * kNanoseconds));
    text(frame);
  }
  void pose(const SE3& pose) {
    const Eigen::Vector3d& t = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    reals({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
  }
  std::string bytes() { return std::move(bytes_); }

 private:
  static constexpr size_t kPreambleBytes = 4;
  bool is_cdr_;
  std::string bytes_;
};

bool is_jpeg(const image_t& image) { return image.pixelformat == image_t::PIXEL_FORMAT_MJPEG; }

const char* encoding_of(const image_t& image) {
  if (image.pixelformat == image_t::PIXEL_FORMAT_GRAY) return "mono8";
  return image.pixelformat == image_t::PIXEL_FORMAT_RGB ? "rgb8" : "yuv422_yuy2";
}

}  // namespace

const char* type_of(const image_t& image) { return is_jpeg(image) ? kCompressedImageType : kImageType; }

std::string image_message(const image_t& image, Ros ros) {
  MessageWriter out(ros);
  out.header(image.utime, kCameraFrame);
  if (is_jpeg(image)) {
    out.text("jpeg");
  } else {
    out.count(static_cast<size_t>(image.height));
    out.count(static_cast<size_t>(image.width));
    out.text(encoding_of(image));
    out.number(uint8_t{0});  // is_bigendian
    out.count(static_cast<size_t>(image.row_stride));
  }
  out.data(image.data);
  return out.bytes();
}

std::string camera_info_message(const Camera& camera, int64_t utime_us, Ros ros) {
  const Camera& c = camera;
  const bool is_fisheye = c.model == Camera::Model::kKannalaBrandt;
  MessageWriter out(ros);
  out.header(utime_us, kCameraFrame);
  out.count(static_cast<size_t>(c.height));
  out.count(static_cast<size_t>(c.width));
  out.text(is_fisheye ? "equidistant" : "plumb_bob");
  out.count(is_fisheye ? 4 : 5);
  if (is_fisheye)
    out.reals({c.k1, c.k2, c.k3, c.k4});
  else
    out.reals({c.k1, c.k2, c.p1, c.p2, c.k3});
  out.reals({c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1});           // K
  out.reals({1, 0, 0, 0, 1, 0, 0, 0, 1});                       // R
  out.reals({c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0});  // P
  constexpr int kOfBinningAndRegion = 6;                        // numbers that are 0 for the whole image
  for (int i = 0; i < kOfBinningAndRegion; ++i) out.count(0);
  out.number(uint8_t{0});  // do_rectify
  return out.bytes();
}

std::string pose_message(const TimedPose& pose, Ros ros) {
  MessageWriter out(ros);
  out.header(pose.utime_us, kMapFrame);
  out.pose(pose.map_from_cam);
  return out.bytes();
}

std::string transforms_message(const TimedPose& pose, Ros ros) {
  MessageWriter out(ros);
  out.count(1);
  out.header(pose.utime_us, kMapFrame);
  out.text(kCameraFrame);
  out.pose(pose.map_from_cam);
  return out.bytes();
}

std::string path_message(const std::vector<TimedPose>& poses, Ros ros) {
  MessageWriter out(ros);
  out.header(poses.empty() ? 0 : poses.front().utime_us, kMapFrame);
  out.count(poses.size());
  for (const TimedPose& pose : poses) {
    out.header(pose.utime_us, kMapFrame);
    out.pose(pose.map_from_cam);
  }
  return out.bytes();
}

}  // namespace rumi
