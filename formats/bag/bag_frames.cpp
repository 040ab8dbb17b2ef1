// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "bus/transport/bus.h"
#include "bus/wire/image_codec.h"
#include "formats/bag/bag_topics.h"
#include "formats/bag/camera_info.h"
#include "formats/bag/ros_pixels.h"
#include "formats/image/image_file.h"
#include "formats/recording/dataset_folder.h"
#include "formats/recording/frame_reader.h"
#include "formats/times/odd_times.h"

namespace rumi {
namespace {

class BagFrames : public FrameReader {
 public:
  BagFrames(std::string path, std::unique_ptr<BagFile> bag, BagTopic topic, std::string calibration,
            std::optional<GreyRange> range)
      : path_(std::move(path)),
        bag_(std::move(bag)),
        topic_(std::move(topic)),
        calibration_(std::move(calibration)),
        range_(range) {
    choose_times();
    count_damage();
  }

  const std::vector<int64_t>& utimes() const override { return utimes_; }
  std::string where(size_t frame) const override {
    return fmt::format("{}: image {} of {}", path_, frame, topic_.name);
  }
  Result<image_t> load(size_t frame, bool colour) override {
    std::vector<uint8_t> message;
    if (!read_message(*bag_, topic_.kind, topic_.messages[frame].place, &message))
      return Error{"cannot be read: the bag is damaged there", where(frame)};
    Result<image_t> image = is_compressed() ? load_compressed(message, colour) : load_raw(message, colour);
    if (!image) return Error{image.error_text(), where(frame)};
    if (!calibration_.empty()) set_metadata(&*image, kCalibrationKey, calibration_);
    return image;
  }
  Malformed malformed() const override { return malformed_; }
  std::vector<std::string> notes() const override { return notes_; }
  std::string why_no_calibration() const override { return why_no_calibration_; }
  std::string why_no_times() const override { return why_no_times_; }
  int64_t missing_at_end() const override { return bag_->missing_messages(topic_.name, found_); }
  std::optional<int64_t> last_recorded_us() const override { return last_recorded_us_; }
  void set_why_no_calibration(const std::string& why) { why_no_calibration_ = why; }
  void add_note(const std::string& note) {
    if (!note.empty()) notes_.push_back(note);
  }

 private:
  bool is_compressed() const { return topic_.kind.type == "sensor_msgs/CompressedImage"; }

  void choose_times() {
    std::vector<BagEntry>& messages = topic_.messages;
    const bool has_stamps =
        std::any_of(messages.begin(), messages.end(), [](const BagEntry& entry) { return entry.stamp_ns != 0; });
    if (!has_stamps)
      add_note(
          fmt::format("the images of {} have no times of their own (header.stamp is 0): they have those at which "
                      "the bag recorded them",
                      topic_.name));
    const auto utime_of = [&](const BagEntry& entry) {
      constexpr int64_t kPerMicrosecond = 1000;
      return ((has_stamps ? entry.stamp_ns : entry.time_ns) + kPerMicrosecond / 2) / kPerMicrosecond;
    };
    for (const BagEntry& entry : messages)
      last_recorded_us_ = std::max(last_recorded_us_.value_or(entry.time_ns / 1000), entry.time_ns / 1000);
    found_ = static_cast<int64_t>(messages.size());
    for (const BagEntry& entry : messages) utimes_.push_back(utime_of(entry));
    why_no_times_ = why_negative(utimes_);
    if (!why_no_times_.empty()) std::fill(utimes_.begin(), utimes_.end(), 0);
    if (!why_no_times_.empty()) return;
    const auto good_end = std::remove_if(messages.begin(), messages.end(),
                                         [&](const BagEntry& entry) { return !plausible_utime(utime_of(entry)); });
    malformed_.count = messages.end() - good_end;
    if (malformed_.count > 0) malformed_.first = fmt::format("{}: an image of {} is of no time", path_, topic_.name);
    messages.erase(good_end, messages.end());
    utimes_.clear();
    for (const BagEntry& entry : messages) utimes_.push_back(utime_of(entry));
  }

  // Counts damage as broken images: as many as the damaged bytes would have held.
  void count_damage() {
    const BagDamage& damage = bag_->damage();
    if (!damage.at_end.empty()) add_note(damage.at_end);
    if (damage.places == 0) return;
    if (malformed_.count == 0) malformed_.first = damage.first;
    const auto images = static_cast<double>(utimes_.size());
    const double share = static_cast<double>(damage.bytes) / std::max(1.0, static_cast<double>(bag_->size_bytes()));
    malformed_.count += std::max(damage.places, static_cast<int64_t>(share * images));
  }

  Result<image_t> load_raw(Bytes message, bool colour) {
    Result<cv::Mat> pixels = raw_pixels(message, colour);
    if (!pixels) return pixels.error();
    if (pixels->depth() == CV_16U) *pixels = to_8_bit(*pixels, range());
    return pixels->channels() == 1 ? make_grey_image(0, *pixels) : make_rgb_image(0, *pixels);
  }
  Result<cv::Mat> raw_pixels(Bytes message, bool colour) const {
    RosImage image;
    if (parse(message, topic_.kind.encoding, &image)) return pixels_of(image, colour);
    return Error{"is no sensor_msgs/Image, or broken"};
  }

  // Returns the bytes of the JPEG or PNG file in the message; an Error if the message is broken.
  Result<std::vector<uint8_t>> file_in(Bytes message) const {
    RosCompressedImage image;
    if (!parse(message, topic_.kind.encoding, &image)) return Error{"is no sensor_msgs/CompressedImage, or broken"};
    return std::vector<uint8_t>(image.data.begin(), image.data.end());
  }
  // Returns the format if the message is a packet of a video, such as "h264"; empty if it is an image.
  std::string video_in(Bytes message, const std::vector<uint8_t>& file) const {
    static constexpr std::array kFormats = {"h264", "h265", "hevc", "avc", "av1", "vp8", "vp9", "mpeg4", "theora"};
    RosCompressedImage image;
    parse(message, topic_.kind.encoding, &image);
    std::string format = image.format;
    std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const char* one : kFormats)
      if (format.find(one) != std::string::npos) return one;
    // H.264 and H.265 begin each of their units with these bytes.
    static constexpr std::array<uint8_t, 4> kBegin = {0, 0, 0, 1};
    const bool begins_so = file.size() > 4 && (std::equal(kBegin.begin(), kBegin.end(), file.begin()) ||
                                               std::equal(kBegin.begin() + 1, kBegin.end(), file.begin()));
    return begins_so ? "H.264 or H.265" : "";
  }
  Result<image_t> load_compressed(Bytes message, bool colour) {
    Result<std::vector<uint8_t>> file = file_in(message);
    if (!file) return file.error();
    if (const std::string video = video_in(message, *file); !video.empty())
      return Error{fmt::format("is a packet of a video ({}), which is not read: {}", video, kHowToUnpackVideos)};
    return load_image_bytes(std::move(*file), colour, [this] { return range(); });
  }

  GreyRange range() {
    if (range_) return *range_;
    GreyHistogram histogram;
    const size_t count = std::min(utimes_.size(), GreyHistogram::kMostImages);
    for (size_t i = 0; i < count; ++i) {
      std::vector<uint8_t> message;
      if (!read_message(*bag_, topic_.kind, topic_.messages[i * utimes_.size() / count].place, &message)) continue;
      if (!is_compressed())
        histogram.add(raw_pixels(message, /*colour=*/false).value_or(cv::Mat()));
      else if (const Result<std::vector<uint8_t>> file = file_in(message))
        histogram.add(grey_pixels_of_bytes(*file));
    }
    range_ = histogram.range();
    tell_grey_range(path_, *range_);
    return *range_;
  }

  std::string path_;
  std::unique_ptr<BagFile> bag_;
  BagTopic topic_;
  std::string calibration_;  // empty: the bag has none
  std::optional<GreyRange> range_;
  std::vector<int64_t> utimes_;
  std::string why_no_times_;
  int64_t found_ = 0;
  std::optional<int64_t> last_recorded_us_;
  Malformed malformed_;
  std::vector<std::string> notes_;
  std::string why_no_calibration_;
};

// Returns nullopt if the message is broken.
std::optional<RosCameraInfo> camera_info_in(BagFile& bag, const BagTopic& topic, const BagEntry& entry) {
  std::vector<uint8_t> message;
  RosCameraInfo info;
  const bool is_whole =
      read_message(bag, topic.kind, entry.place, &message) && parse(message, topic.kind.encoding, &info);
  return is_whole ? std::optional(info) : std::nullopt;
}

struct FoundCalibration {
  std::string text;  // calibration from the first message that has one; may be empty
  std::string note;
  std::string why_none;     // why the messages have no calibration; empty if they have, or if there are no messages
  bool is_nominal = false;  // it has the values that the driver gives for every Kinect
};

FoundCalibration calibration_of(BagFile& bag, const BagTopics& topics, const std::string& images) {
  FoundCalibration found;
  const BagTopic* topic = calibration_beside(topics, images);
  if (!topic) return found;
  const bool is_rectified = is_rectified_topic(images);
  for (size_t i = 0; found.text.empty() && i < topic->messages.size(); ++i) {
    const std::optional<RosCameraInfo> info = camera_info_in(bag, *topic, topic->messages[i]);
    if (info && is_calibrated(*info, is_rectified)) found.text = camera_info_text(*info, is_rectified);
    found.is_nominal = info && is_nominal_kinect(*info);
  }
  if (found.text.empty()) {
    found.why_none = fmt::format("{} is all zero: whoever recorded it had no calibration", topic->name);
    return found;
  }
  const std::optional<RosCameraInfo> last = camera_info_in(bag, *topic, topic->messages.back());
  if (last && camera_info_text(*last, is_rectified) != found.text)
    found.note = fmt::format("{} is another one at the end: the first one is used for all images", topic->name);
  return found;
}

// Returns a description of the bag's damage, to be appended to an error; may be empty.
std::string damage_of(const BagFile& bag) {
  std::string text;
  for (const std::string& damage : {bag.damage().first, bag.damage().at_end})
    if (!damage.empty()) text += "; it is damaged: " + damage;
  return text;
}

}  // namespace

OpenedReader open_bag(const std::filesystem::path& path, const std::string& channel,
                      std::optional<GreyRange> grey_range) {
  const std::string name = path.string();
  std::unique_ptr<BagFile> bag = open_bag_file(name);
  const BagTopics topics = read_topics(*bag);
  if (const std::string why = bag->refusal(); !why.empty()) return Error{why, name};
  const Result<ChosenTopic> chosen = choose_topic(topics, channel);
  if (!chosen) return Error{chosen.error_text() + damage_of(*bag), name};
  const FoundCalibration calibration = calibration_of(*bag, topics, chosen->topic->name);
  const std::vector<std::string> notes = bag->notes();
  auto reader = std::make_unique<BagFrames>(name, std::move(bag), *chosen->topic, calibration.text, grey_range);
  if (reader->utimes().empty()) return Error{reader->malformed().first, name};
  reader->add_note(chosen->note);
  reader->add_note(calibration.note);
  if (const std::string advice = advice_on_known_camera(path, channel); calibration.is_nominal && !advice.empty())
    reader->add_note("its camera_info has the nominal values of the Kinect's driver" + advice);
  reader->set_why_no_calibration(calibration.why_none);
  for (const std::string& note : notes) reader->add_note(note);
  return OpenedReader(std::move(reader));
}

}  // namespace rumi
