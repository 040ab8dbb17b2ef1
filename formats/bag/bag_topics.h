// SPDX-License-Identifier: BSD-3-Clause
// Lists the topics of a bag, and chooses the one to play.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/bag/bag_file.h"

namespace rumi {

struct BagEntry {
  BagPlace place;
  uint32_t connection = 0;
  int64_t stamp_ns = 0;  // time in the message's header
  int64_t time_ns = 0;   // time of recording
};

// Packets of a video cannot be read one by one: each needs the packets before it.
inline constexpr const char* kHowToUnpackVideos =
    "let ROS write images (`ros2 run image_transport republish` while the bag is played) and record these";

struct BagTopic {
  std::string name;
  BagConnection kind;
  std::vector<BagEntry> messages;
  bool is_depth = false;
};

// Reads a message, and decompresses it if it was compressed by itself. A message of Foxglove is converted to ROS 1's
// form, as parse() expects. Returns false if it cannot be read.
bool read_message(BagFile& bag, const BagConnection& kind, const BagPlace& place, std::vector<uint8_t>* message);

struct BagTopics {
  std::vector<BagTopic> images, calibrations, transforms;         // all have messages; images that are no depth first
  std::map<std::string, std::pair<std::string, int64_t>> others;  // by topic: type, and number of messages
  bool is_damaged = false;                                        // there may have been more topics
};
BagTopics read_topics(BagFile& bag);

struct ChosenTopic {
  const BagTopic* topic = nullptr;
  std::string note;  // which topics are not played; may be empty
};
// `channel`: the topic that the user named, or the default of log_channel, which is no topic's name. An Error says how
// to choose, or that there are no images.
Result<ChosenTopic> choose_topic(const BagTopics& topics, const std::string& channel);
// Returns the camera_info beside the topic; nullptr if there is none.
const BagTopic* calibration_beside(const BagTopics& topics, const std::string& topic);

}  // namespace rumi
