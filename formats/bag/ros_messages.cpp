// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/ros_messages.h"

#include <algorithm>
#include <bit>

namespace rumi {
namespace {

int64_t time_ns(uint32_t seconds, uint32_t nanoseconds, bool has_sign) {
  constexpr int64_t kNanoseconds = 1'000'000'000;
  const int64_t with_sign = has_sign ? static_cast<int32_t>(seconds) : int64_t{seconds};
  return with_sign * kNanoseconds + nanoseconds;
}

// Reads one value after the other. Values beyond the end are 0 or empty, and is_ok() is false then.
class MessageReader {
 public:
  MessageReader(Bytes bytes, RosEncoding encoding) : bytes_(bytes), is_cdr_(encoding == RosEncoding::kCdr) {
    if (!is_cdr_) return;
    // The second byte says whether numbers are big or little endian. Other values (parameter lists, version 2) are not
    // used by ROS.
    constexpr size_t kPreambleBytes = 4;
    is_ok_ = bytes.size() >= kPreambleBytes && bytes[0] == 0 && bytes[1] <= 1;
    is_big_endian_ = is_ok_ && bytes[1] == 0;
    bytes_ = bytes.subspan(std::min(kPreambleBytes, bytes.size()));
  }

  bool is_ok() const { return is_ok_; }
  uint8_t byte() { return static_cast<uint8_t>(number(1)); }
  uint32_t number32() { return static_cast<uint32_t>(number(4)); }
  double real() { return std::bit_cast<double>(number(8)); }
  Bytes data() { return take(number32()); }
  std::string text() {
    const Bytes bytes = data();
    std::string text(bytes.begin(), bytes.end());
    if (is_cdr_ && !text.empty() && text.back() == '\0') text.pop_back();
    return text;
  }
  struct Header {
    int64_t stamp_ns = 0;
    std::string frame;
  };
  Header header() {
    Header header;
    if (!is_cdr_) number32();  // seq
    const uint32_t seconds = number32(), nanoseconds = number32();
    header.stamp_ns = time_ns(seconds, nanoseconds, is_cdr_);
    header.frame = frame();
    return header;
  }
  std::string frame() {
    std::string name = text();
    return name.starts_with('/') ? name.substr(1) : name;  // older versions of ROS write a leading slash
  }
  bool is_at_end() const { return bytes_.empty(); }
  template <size_t kCount>
  void reals(std::array<double, kCount>* values) {
    for (double& value : *values) value = real();
  }
  std::vector<double> list() {
    const uint32_t count = number32();
    std::vector<double> values;
    if (count > bytes_.size() / 8) fail();
    for (uint32_t i = 0; i < count && is_ok_; ++i) values.push_back(real());
    return values;
  }

 private:
  Bytes fail() {
    is_ok_ = false;
    return bytes_ = {};
  }
  Bytes take(size_t count) {
    if (count > bytes_.size()) return fail();
    const Bytes taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    at_ += count;
    return taken;
  }
  // CDR aligns each number to its size.
  void align(size_t size) {
    if (is_cdr_) take((size - at_ % size) % size);
  }
  uint64_t number(size_t size) {
    align(size);
    const Bytes taken = take(size);
    uint64_t value = 0;
    for (size_t i = 0; i < taken.size(); ++i)
      value |= uint64_t{taken[is_big_endian_ ? taken.size() - 1 - i : i]} << 8 * i;
    return value;
  }

  Bytes bytes_;
  size_t at_ = 0;  // position behind the preamble
  bool is_cdr_, is_ok_ = true, is_big_endian_ = false;
};

}  // namespace

bool parse(Bytes message, RosEncoding encoding, RosImage* image) {
  MessageReader in(message, encoding);
  in.header();
  image->height = in.number32();
  image->width = in.number32();
  image->encoding = in.text();
  image->is_big_endian = in.byte() != 0;
  image->step = in.number32();
  image->data = in.data();
  return in.is_ok();
}

bool parse(Bytes message, RosEncoding encoding, RosCompressedImage* image) {
  MessageReader in(message, encoding);
  in.header();
  image->format = in.text();
  image->data = in.data();
  return in.is_ok();
}

bool parse(Bytes message, RosEncoding encoding, RosCameraInfo* info) {
  MessageReader in(message, encoding);
  in.header();
  info->height = in.number32();
  info->width = in.number32();
  info->distortion_model = in.text();
  info->d = in.list();
  in.reals(&info->k);
  in.reals(&info->r);
  in.reals(&info->p);
  info->binning_x = in.number32();
  info->binning_y = in.number32();
  info->roi_x = in.number32();
  info->roi_y = in.number32();
  info->roi_height = in.number32();
  info->roi_width = in.number32();
  in.byte();  // do_rectify
  return in.is_ok();
}

bool parse(Bytes message, RosEncoding encoding, std::vector<RosTransform>* transforms) {
  MessageReader in(message, encoding);
  const uint32_t count = in.number32();
  for (uint32_t i = 0; i < count && in.is_ok() && !in.is_at_end(); ++i) {
    const MessageReader::Header header = in.header();
    RosTransform transform = {header.stamp_ns, header.frame, in.frame(), {}};
    std::array<double, 7> v{};  // x y z of the translation, x y z w of the rotation
    in.reals(&v);
    const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    constexpr double kLongest = 1.1, kShortest = 0.9;  // lengths of a quaternion that was rounded
    if (!in.is_ok() || !(rotation.norm() > kShortest && rotation.norm() < kLongest)) continue;
    transform.parent_from_child = SE3(rotation, Eigen::Vector3d(v[0], v[1], v[2]));
    if (transform.parent_from_child.is_finite()) transforms->push_back(std::move(transform));
  }
  return in.is_ok();
}

int64_t stamp_ns(Bytes head, RosEncoding encoding) {
  // The stamp follows seq in ROS 1, and the preamble in ROS 2, both of 4 bytes.
  std::vector<uint8_t> padded(head.begin(), head.end());
  padded.resize(kHeadBytes);
  MessageReader in(padded, encoding);
  if (encoding != RosEncoding::kCdr) in.number32();
  const uint32_t seconds = in.number32(), nanoseconds = in.number32();
  return time_ns(seconds, nanoseconds, encoding == RosEncoding::kCdr);
}

std::string frame_of(Bytes message, RosEncoding encoding) {
  MessageReader in(message, encoding);
  const std::string frame = in.header().frame;
  return in.is_ok() ? frame : "";
}

}  // namespace rumi
