// SPDX-License-Identifier: BSD-3-Clause
// Makes the answers and events of the page of `rumi web` from messages. It publishes only requests to map_server for
// submaps, and only while somebody looks.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/running/due.h"
#include "bus/transport/bus.h"
#include "rumi/run/live_status.h"
#include "rumi/web/live_image.h"
#include "rumi/web/live_map.h"
#include "rumi/web/page_files.h"

namespace rumi::tool {

class WebNode {
 public:
  using Tell = std::function<void(const std::string& event, const std::string& data)>;

  // bus_name: shown on the page, to a person who sees nothing else on it. tell: sends an event to all open pages.
  WebNode(Bus& bus, PageFiles files, std::string bus_name, Tell tell);

  HttpAnswer answer(const std::string& path);
  void tick(int64_t now_us, bool watched);

 private:
  struct Told {
    std::string map, timeline, pose;
    std::optional<int64_t> image_us;
    int64_t pose_us = kNever_us, image_told_us = kNever_us, status_us = kNever_us;
  };
  void tell_if_new(const char* event, const std::string& data, std::string* told);

  Bus& bus_;
  PageFiles files_;
  std::string bus_name_;
  Tell tell_;
  LiveStatus status_;
  LiveMap map_;
  LiveImage image_;
  bool watched_ = false;
  Told told_;
};

}  // namespace rumi::tool
