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
  int64_t stamp_ns = 0;  // stamp of the image
  int64_t time_ns = 0;   // time of recording
};

// Images that are packets of a video need those before them.
inline constexpr const char* kHowToUnpackVideos =
    "let ROS write images (`ros2 run image_transport republish` while the bag is played) and record these";

struct BagTopic {
  std::string name;
  BagConnection kind;
  std::vector<BagEntry> messages;
  bool is_depth = false;
};

// The message, also if it was compressed by itself. One of Foxglove becomes one of ROS 1, which parse() takes it for.
// False if it cannot be had.
bool read_message(BagFile& bag, const BagConnection& kind, const BagPlace& place, std::vector<uint8_t>* message);

struct BagTopics {
  std::vector<BagTopic> images, calibrations, transforms;         // none is empty; images that are no depth first
  std::map<std::string, std::pair<std::string, int64_t>> others;  // topic: type and messages
  bool is_damaged = false;                                        // there may have been more topics
};
BagTopics read_topics(BagFile& bag);

struct ChosenTopic {
  const BagTopic* topic = nullptr;
  std::string note;  // which topics are not played; may be empty
};
// `channel`: as the user gave it, or the default, which is no topic's name. An Error says how to choose, or that there
// are no images.
Result<ChosenTopic> choose_topic(const BagTopics& topics, const std::string& channel);
// The camera_info beside the topic; null if there is none.
const BagTopic* calibration_beside(const BagTopics& topics, const std::string& topic);

}  // namespace rumi
