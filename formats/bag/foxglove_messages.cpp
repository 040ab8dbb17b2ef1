// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/foxglove_messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "formats/image/byte_source.h"

namespace rumi {
namespace {

using Bytes = std::span<const uint8_t>;

// Fields of all three kinds of messages; each kind has some of them.
struct Content {
  uint64_t seconds = 0, nanoseconds = 0, width = 0, height = 0, step = 0;
  std::string frame, format;  // format: that of the file, of the pixels, or of the distortion
  std::vector<uint8_t> data;
  std::array<std::vector<double>, 4> d_k_r_p;
};

// --- protobuf: each field is a number with a kind, and its value

class ProtobufReader {
 public:
  explicit ProtobufReader(Bytes bytes) : bytes_(bytes) {}
  bool is_ok() const { return is_ok_; }

  struct Field {
    uint64_t number = 0, value = 0;
    Bytes bytes;
  };
  std::optional<Field> next() {
    if (bytes_.empty()) return std::nullopt;
    enum Kind : uint64_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
    const uint64_t key = varint();
    Field field{key >> 3, 0, {}};
    const uint64_t kind = key & 7;
    if (kind == kVarint)
      field.value = varint();
    else if (kind == kFixed64)
      field.bytes = take(8);
    else if (kind == kFixed32)
      field.bytes = take(4);
    else if (kind == kBytes)
      field.bytes = take(varint());
    else
      is_ok_ = false;
    if (kind == kFixed64 || kind == kFixed32) field.value = little_endian<uint64_t>(padded(field.bytes));
    return is_ok_ ? std::optional(field) : std::nullopt;
  }

 private:
  static std::vector<uint8_t> padded(Bytes bytes) {
    std::vector<uint8_t> out(bytes.begin(), bytes.end());
    out.resize(8);
    return out;
  }
  Bytes take(uint64_t count) {
    is_ok_ = is_ok_ && count <= bytes_.size();
    if (!is_ok_) return {};
    const Bytes taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  uint64_t varint() {
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const Bytes byte = take(1);
      if (byte.empty()) return 0;
      value |= uint64_t{byte[0] & 0x7fu} << shift;
      if ((byte[0] & 0x80) == 0) return value;
    }
    is_ok_ = false;
    return 0;
  }

  Bytes bytes_;
  bool is_ok_ = true;
};

// The numbers of the fields in Foxglove's schemas; 0: the message has no such field.
struct FieldNumbers {
  uint64_t width, height, step, frame, format, data, d;  // k, r and p follow d
};
FieldNumbers numbers_of(const std::string& ros_type) {
  if (ros_type == "sensor_msgs/CompressedImage") return {0, 0, 0, 4, 3, 2, 0};
  if (ros_type == "sensor_msgs/Image") return {2, 3, 5, 7, 4, 6, 0};
  return {2, 3, 0, 9, 4, 0, 5};
}

void take_time(Bytes message, Content* content) {
  ProtobufReader in(message);
  while (const auto field = in.next()) (field->number == 1 ? content->seconds : content->nanoseconds) = field->value;
}

// Appends the numbers of a field. They may be packed in one field, or have a field each.
void take_reals(const ProtobufReader::Field& field, std::vector<double>* reals) {
  if (field.bytes.size() == 8) return reals->push_back(std::bit_cast<double>(little_endian<uint64_t>(field.bytes)));
  for (size_t at = 0; at + 8 <= field.bytes.size(); at += 8)
    reals->push_back(std::bit_cast<double>(little_endian<uint64_t>(field.bytes.subspan(at, 8))));
}

std::optional<Content> content_of_protobuf(Bytes message, const std::string& ros_type) {
  const FieldNumbers numbers = numbers_of(ros_type);
  Content content;
  ProtobufReader in(message);
  while (const auto field = in.next()) {
    const uint64_t number = field->number;
    const std::string text(field->bytes.begin(), field->bytes.end());
    if (number == 1) take_time(field->bytes, &content);
    if (number == numbers.width) content.width = field->value;
    if (number == numbers.height) content.height = field->value;
    if (number == numbers.step) content.step = field->value;
    if (number == numbers.frame) content.frame = text;
    if (number == numbers.format) content.format = text;
    if (number == numbers.data) content.data.assign(field->bytes.begin(), field->bytes.end());
    if (numbers.d > 0 && number >= numbers.d && number < numbers.d + 4)
      take_reals(*field, &content.d_k_r_p[number - numbers.d]);
  }
  return in.is_ok() ? std::optional(std::move(content)) : std::nullopt;
}

// --- JSON

std::vector<uint8_t> from_base64(const std::string& text) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value_of{};
  value_of.fill(-1);
  for (size_t i = 0; i < kLetters.size(); ++i) value_of[static_cast<uint8_t>(kLetters[i])] = static_cast<int>(i);
  std::vector<uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = value_of[static_cast<uint8_t>(c)];
    if (value < 0) continue;
    bits = bits << 6 | static_cast<uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> count));
  }
  return bytes;
}

std::optional<Content> content_of_json(Bytes message, const std::string& ros_type) {
  using nlohmann::json;
  const json in = json::parse(message.begin(), message.end(), nullptr, /*allow_exceptions=*/false);
  if (!in.is_object()) return std::nullopt;
  Content content;
  try {
    const json time = in.value("timestamp", json::object());
    content.seconds = time.value("sec", uint64_t{0});
    content.nanoseconds = time.value("nsec", uint64_t{0});
    content.width = in.value("width", uint64_t{0});
    content.height = in.value("height", uint64_t{0});
    content.step = in.value("step", uint64_t{0});
    content.frame = in.value("frame_id", "");
    const char* format = ros_type == "sensor_msgs/CompressedImage" ? "format"
                         : ros_type == "sensor_msgs/Image"         ? "encoding"
                                                                   : "distortion_model";
    content.format = in.value(format, "");
    content.data = from_base64(in.value("data", ""));
    for (size_t i = 0; i < content.d_k_r_p.size(); ++i)
      content.d_k_r_p[i] = in.value(std::string(1, "DKRP"[i]), std::vector<double>());
  } catch (const json::exception&) {
    return std::nullopt;  // a field has another type than it should
  }
  return content;
}

// --- as ROS 1 writes it

class Ros1Message {
 public:
  Ros1Message& number(uint64_t value, size_t bytes = 4) {
    for (size_t i = 0; i < bytes; ++i) bytes_.push_back(static_cast<uint8_t>(value >> 8 * i));
    return *this;
  }
  template <class Container>
  Ros1Message& data(const Container& container) {
    number(container.size());
    bytes_.insert(bytes_.end(), container.begin(), container.end());
    return *this;
  }
  Ros1Message& reals(std::vector<double> values, size_t count) {
    values.resize(count);
    for (const double value : values) number(std::bit_cast<uint64_t>(value), 8);
    return *this;
  }
  std::vector<uint8_t> bytes() && { return std::move(bytes_); }

 private:
  std::vector<uint8_t> bytes_;
};

}  // namespace

std::string ros_type_of_foxglove(const std::string& type) {
  if (type == "foxglove.CompressedImage") return "sensor_msgs/CompressedImage";
  if (type == "foxglove.RawImage") return "sensor_msgs/Image";
  if (type == "foxglove.CameraCalibration") return "sensor_msgs/CameraInfo";
  return {};
}

std::vector<uint8_t> ros_message_of_foxglove(Bytes message, RosEncoding encoding, const std::string& ros_type) {
  const std::optional<Content> content =
      encoding == RosEncoding::kJson ? content_of_json(message, ros_type) : content_of_protobuf(message, ros_type);
  if (!content) return {};
  Ros1Message out;
  out.number(0).number(content->seconds).number(content->nanoseconds).data(content->frame);
  if (ros_type == "sensor_msgs/CompressedImage")
    return std::move(out.data(content->format).data(content->data)).bytes();
  out.number(content->height).number(content->width).data(content->format);
  if (ros_type == "sensor_msgs/Image")
    return std::move(out.number(0, 1).number(content->step).data(content->data)).bytes();
  constexpr std::array<size_t, 4> kCounts = {0, 9, 9, 12};
  out.number(content->d_k_r_p[0].size()).reals(content->d_k_r_p[0], content->d_k_r_p[0].size());
  for (size_t i = 1; i < kCounts.size(); ++i) out.reals(content->d_k_r_p[i], kCounts[i]);
  constexpr size_t kBinningAndRegion = 6;
  for (size_t i = 0; i < kBinningAndRegion; ++i) out.number(0);
  return std::move(out.number(0, 1)).bytes();
}

}  // namespace rumi
