// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/foxglove_messages.h"

#include "bus/wire/image_codec.h"
#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

std::string varint(uint64_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>((value & 127) | 128);
  return bytes + static_cast<char>(value);
}
std::string field(uint64_t number, const std::string& bytes) {
  return varint(number << 3 | 2) + varint(bytes.size()) + bytes;
}
std::string fixed32(uint64_t number, uint32_t value) { return varint(number << 3 | 5) + bytes_of(value); }
std::string reals(uint64_t number, const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) bytes += bytes_of(std::bit_cast<uint64_t>(value));
  return field(number, bytes);
}
std::string time_field(int64_t ns) {
  return field(1, varint(1 << 3) + varint(ns / 1'000'000'000) + varint(2 << 3) + varint(ns % 1'000'000'000));
}

std::string base64(const std::string& bytes) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  uint32_t bits = 0;
  int count = 0;
  for (const char byte : bytes) {
    bits = bits << 8 | static_cast<uint8_t>(byte);
    for (count += 8; count >= 6; count -= 6) text += letters[bits >> (count - 6) & 63];
  }
  if (count > 0) text += letters[bits << (6 - count) & 63];
  while (text.size() % 4 != 0) text += '=';
  return text;
}
std::string json_time(int64_t ns) {
  return fmt::format(R"("timestamp":{{"sec":{},"nsec":{}}})", ns / 1'000'000'000, ns % 1'000'000'000);
}

class FoxgloveMessages : public Bags {
 protected:
  void add(const std::string& topic, const std::string& type, const std::string& message) {
    mcap_.add({topic, type, message, 5});
  }
  std::string file() { return folder_.write("a.mcap", mcap_.bytes()); }
  static std::string png(int number) {
    std::vector<uint8_t> bytes;
    cv::imencode(".png", picture(number), bytes);
    return {bytes.begin(), bytes.end()};
  }
  static std::string raw(int number) {
    const cv::Mat pixels = picture(number);
    return {pixels.datastart, pixels.dataend};
  }
  void expect_pictures() {
    const std::vector<image_t> images = play(file());
    ASSERT_EQ(images.size(), 5u);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(images[i].utime, stamp_ns(i) / 1000);
      EXPECT_EQ(cv::norm(decode_grey(images[i]).value(), picture(i), cv::NORM_INF), 0);
    }
    EXPECT_EQ(camera_.fx, 50);
    EXPECT_EQ(camera_.k1, 0.1);
  }
  McapWriter mcap_{"zstd", "protobuf"};
};

TEST_F(FoxgloveMessages, OfProtobufArePlayed) {
  add("/cam/camera_info", "foxglove.CameraCalibration",
      time_field(stamp_ns(0)) + fixed32(2, 64) + fixed32(3, 48) + field(4, "plumb_bob") + reals(5, {0.1, 0, 0, 0, 0}) +
          reals(6, {50, 0, 32, 0, 51, 24, 0, 0, 1}) + reals(7, {1, 0, 0, 0, 1, 0, 0, 0, 1}));
  for (int i = 0; i < 5; ++i)
    add("/cam/image", "foxglove.CompressedImage",
        field(2, png(i)) + field(3, "png") + field(4, "camera") + time_field(stamp_ns(i)));  // the time may come last
  expect_pictures();
}

TEST_F(FoxgloveMessages, OfPixelsArePlayed) {
  give_calibration();
  for (int i = 0; i < 5; ++i)
    add("/cam/image", "foxglove.RawImage",
        time_field(stamp_ns(i)) + fixed32(2, 64) + fixed32(3, 48) + field(4, "mono8") + fixed32(5, 64) +
            field(6, raw(i)) + field(7, "camera"));
  expect_pictures();
}

TEST_F(FoxgloveMessages, OfJsonArePlayed) {
  mcap_ = McapWriter("none", "json");
  add("/cam/calibration", "foxglove.CameraCalibration",
      fmt::format(R"({{{},"frame_id":"camera","width":64,"height":48,"distortion_model":"plumb_bob",)"
                  R"("D":[0.1,0,0,0,0],"K":[50,0,32,0,51,24,0,0,1],"R":[1,0,0,0,1,0,0,0,1],"P":[]}})",
                  json_time(stamp_ns(0))));
  for (int i = 0; i < 5; ++i)
    add("/cam/image", "foxglove.CompressedImage",
        fmt::format(R"({{{},"frame_id":"camera","format":"png","data":"{}"}})", json_time(stamp_ns(i)),
                    base64(png(i))));
  expect_pictures();
}

TEST_F(FoxgloveMessages, ThatAreBrokenAreLeftOut) {
  give_calibration();
  for (const char* encoding : {"protobuf", "json"}) {
    mcap_ = McapWriter("none", encoding);
    const auto good = [&](int i) {
      if (encoding == std::string("json"))
        return fmt::format(R"({{{},"format":"png","data":"{}"}})", json_time(stamp_ns(i)), base64(png(i)));
      return time_field(stamp_ns(i)) + field(2, png(i)) + field(3, "png");
    };
    for (int i = 0; i < 5; ++i) add("/cam/image", "foxglove.CompressedImage", good(i));
    for (const std::string& bad : {good(5).substr(0, 60), std::string(), std::string("{\"timestamp\":7}"),
                                   std::string(40, '\xff'), std::string("\x12\xff\xff\xff\xff\x7f")})
      add("/cam/image", "foxglove.CompressedImage", bad);
    EXPECT_EQ(play(file()).size(), 5u) << encoding;
    EXPECT_GT(skipped_.total(), 0) << encoding;
  }
}

TEST_F(FoxgloveMessages, OfAVideoSayWhatToDo) {
  add("/cam/video", "foxglove.CompressedVideo", time_field(stamp_ns(0)) + field(3, "x") + field(4, "h264"));
  EXPECT_THAT(error_of(file()), HasSubstr("/cam/video has packets of a video, which are not read"));
}

}  // namespace
}  // namespace rumi::camera_driver
