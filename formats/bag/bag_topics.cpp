// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/bag_topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/text/natural_order.h"
#include "bus/transport/bus.h"
#include "formats/bag/decompress.h"
#include "formats/bag/foxglove_messages.h"
#include "formats/bag/ros_messages.h"
#include "formats/bag/ros_pixels.h"
#include "formats/recording/channel_list.h"

namespace rumi {
namespace {

bool is_depth(BagFile& bag, const BagTopic& topic) {
  std::vector<uint8_t> message;
  if (!read_message(bag, topic.kind, topic.messages.front().place, &message)) return false;
  RosImage image;
  RosCompressedImage compressed;
  if (topic.kind.type == "sensor_msgs/Image")
    return parse(message, topic.kind.encoding, &image) && is_depth_encoding(image.encoding);
  return parse(message, topic.kind.encoding, &compressed) &&
         compressed.format.find("compressedDepth") != std::string::npos;
}

bool is_of_foxglove(const BagConnection& kind) {
  return kind.encoding == RosEncoding::kProtobuf || kind.encoding == RosEncoding::kJson;
}

// Returns the stamp in the message. If the message is compressed by itself, or of Foxglove, all of it must be read for
// that.
int64_t stamp_of(BagFile& bag, const BagMessage& message, const BagConnection& kind) {
  std::vector<uint8_t> whole;
  const bool must_be_read = looks_like_zstd(message.head) || is_of_foxglove(kind);
  if (must_be_read && read_message(bag, kind, message.place, &whole)) {
    whole.resize(std::max(whole.size(), kHeadBytes));
    return stamp_ns(Bytes(whole).first(kHeadBytes), kind.encoding);
  }
  return stamp_ns(message.head, kind.encoding);
}

std::vector<BagTopic> topics_of(const std::map<uint32_t, BagConnection>& connections,
                                const std::vector<BagEntry>& entries, bool (BagConnection::*is_wanted)() const) {
  std::map<std::pair<std::string, std::string>, BagTopic> topics;
  for (const BagEntry& entry : entries) {
    const auto connection = connections.find(entry.connection);
    if (connection == connections.end() || !(connection->second.*is_wanted)()) continue;
    BagTopic& topic = topics[{connection->second.topic, connection->second.type}];
    topic.name = connection->second.topic;
    topic.kind = connection->second;
    topic.messages.push_back(entry);
  }
  std::vector<BagTopic> list;
  list.reserve(topics.size());
  for (auto& [name, topic] : topics) list.push_back(std::move(topic));
  return list;
}

using Counts = std::vector<std::pair<std::string, int64_t>>;

Counts counts_of(const std::vector<BagTopic>& topics) {
  Counts counts;
  for (const BagTopic& topic : topics)
    counts.emplace_back(topic.name + (topic.is_depth ? ", depth" : ""), topic.messages.size());
  return counts;
}

// True if the names differ only in 0 and 1, or left and right: two cameras of one rig. The first one is played, as with
// folders.
bool are_of_one_rig(const std::string& first, const std::string& second) {
  static const std::vector<std::pair<std::string, std::string>> kSides = {{"0", "1"}, {"left", "right"}};
  return std::any_of(kSides.begin(), kSides.end(), [&](const auto& sides) {
    for (size_t at = first.find(sides.first); at != std::string::npos; at = first.find(sides.first, at + 1)) {
      std::string other = first;
      if (other.replace(at, sides.first.size(), sides.second) == second) return true;
    }
    return false;
  });
}

// Names a topic with packets of a video, as ROS and Foxglove store them; empty if there is none.
std::string advice_on_videos(const BagTopics& topics) {
  static const std::vector<std::string> kTypes = {"foxglove_msgs/CompressedVideo", "foxglove.CompressedVideo",
                                                  "ffmpeg_image_transport_msgs/FFMPEGPacket",
                                                  "theora_image_transport/Packet"};
  for (const auto& [topic, other] : topics.others)
    for (const std::string& type : kTypes)
      if (other.first.ends_with(type))
        return fmt::format("; {} has packets of a video, which are not read: {}", topic, kHowToUnpackVideos);
  return {};
}

std::string why_no_images(const BagTopics& topics) {
  Counts counts = counts_of(topics.calibrations);
  for (const BagTopic& topic : topics.transforms)
    counts.emplace_back(fmt::format("{} [{}]", topic.name, topic.kind.type), topic.messages.size());
  for (const auto& [topic, other] : topics.others)
    counts.emplace_back(fmt::format("{} [{}]", topic, other.first), other.second);
  const std::string what = !counts.empty()     ? "it has messages on " + list_of_channels(counts)
                           : topics.is_damaged ? "nothing in it can be read"
                                               : "it is empty";
  return fmt::format("no topic of it has images (sensor_msgs/Image or CompressedImage, or Foxglove's); {}{}", what,
                     advice_on_videos(topics));
}

}  // namespace

bool read_message(BagFile& bag, const BagConnection& kind, const BagPlace& place, std::vector<uint8_t>* message) {
  if (!bag.read(place, message)) return false;
  if (is_of_foxglove(kind)) {
    *message = ros_message_of_foxglove(*message, kind.encoding, kind.type);
    return !message->empty();
  }
  if (!looks_like_zstd(*message)) return true;
  MemoryBytes compressed(*message);
  Decompressed whole = decompress(compressed, 0, compressed.size(), Compression::kZstd);
  *message = std::move(whole.bytes);
  return whole.is_whole;
}

BagTopics read_topics(BagFile& bag) {
  std::vector<BagEntry> entries;
  bag.scan([&](const BagMessage& message) {
    const auto connection = bag.connections().find(message.connection);
    // A connection may come later, behind damage: its messages are then read as ROS 1's, where stamps are at the same
    // place.
    const bool is_known = connection != bag.connections().end();
    const BagConnection kind = is_known ? connection->second : BagConnection{"", "", RosEncoding::kRos1};
    entries.push_back({message.place, message.connection, stamp_of(bag, message, kind), message.time_ns});
    return true;
  });
  BagTopics topics;
  topics.is_damaged = bag.damage().places > 0 || !bag.damage().at_end.empty();
  topics.images = topics_of(bag.connections(), entries, &BagConnection::has_images);
  topics.calibrations = topics_of(bag.connections(), entries, &BagConnection::has_calibration);
  topics.transforms = topics_of(bag.connections(), entries, &BagConnection::has_transforms);
  for (BagTopic& topic : topics.images) topic.is_depth = is_depth(bag, topic);
  std::sort(topics.images.begin(), topics.images.end(), [](const BagTopic& a, const BagTopic& b) {
    return a.is_depth != b.is_depth ? b.is_depth : natural_less(a.name, b.name);
  });
  for (const auto& [connection, messages] : bag.other_messages()) {
    const BagConnection& other = bag.connections().at(connection);
    auto& [type, count] = topics.others[other.topic];
    type = other.type;
    count += messages;
  }
  return topics;
}

Result<ChosenTopic> choose_topic(const BagTopics& topics, const std::string& channel) {
  const std::vector<BagTopic>& images = topics.images;
  for (const BagTopic& topic : images)
    if (topic.name == channel || topic.name == "/" + channel) return ChosenTopic{&topic, ""};
  if (images.empty()) return Error{why_no_images(topics)};
  const bool is_named = channel != channels::kCamera;
  const auto depths = std::count_if(images.begin(), images.end(), [](const BagTopic& topic) { return topic.is_depth; });
  const auto others = static_cast<ptrdiff_t>(images.size()) - depths;
  if (!is_named && images.size() == 1) return ChosenTopic{&images.front(), ""};
  if (!is_named && others == 1)
    return ChosenTopic{&images.front(),
                       fmt::format("{} is played; the other images of the bag are depth ({})", images.front().name,
                                   list_of_channels(counts_of({images.begin() + 1, images.end()})))};
  if (!is_named && others == 2 && are_of_one_rig(images[0].name, images[1].name))
    return ChosenTopic{&images.front(),
                       fmt::format("{} is played, and not {}; --log-channel chooses", images[0].name, images[1].name)};
  return Error{fmt::format("{}{}", is_named ? fmt::format("no images on '{}'; ", channel) : "",
                           advice_on_channels(counts_of(images), images.front().name))};
}

const BagTopic* calibration_beside(const BagTopics& topics, const std::string& topic) {
  const auto above = [](const std::string& name) { return name.substr(0, std::min(name.rfind('/'), name.size())); };
  const std::string parent = above(topic), grandparent = above(parent);
  // The last two names are used by RealSense's own recorder, and by Foxglove's examples.
  for (const std::string& name : {parent + "/camera_info", topic + "/camera_info", grandparent + "/camera_info",
                                  grandparent + "/info/camera_info", parent + "/calibration", topic + "/calibration"})
    for (const BagTopic& calibration : topics.calibrations)
      if (calibration.name == name) return &calibration;
  return nullptr;
}

}  // namespace rumi
