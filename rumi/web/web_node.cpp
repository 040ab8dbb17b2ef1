// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/web_node.h"

#include <utility>

#include "base/text/json_text.h"

namespace rumi::tool {
namespace {

constexpr int64_t kPoseUs = 100'000, kImageUs = LiveImage::kPeriodUs, kStatusUs = 1'000'000;
constexpr const char* kSubmapPath = "/submap/";

}  // namespace

WebNode::WebNode(Bus& bus, PageFiles files, std::string bus_name, Tell tell)
    : bus_(bus),
      files_(std::move(files)),
      bus_name_(std::move(bus_name)),
      tell_(std::move(tell)),
      status_(bus),
      map_(bus),
      image_(bus) {}

HttpAnswer WebNode::answer(const std::string& path) {
  if (const auto file = files_.find(path)) return *file;
  if (path == "/events") return {.type = "text/event-stream", .events = true};
  if (path == "/camera.jpg") {
    if (const auto jpeg = image_.jpeg(bus_.now_us())) return {.type = "image/jpeg", .body = jpeg};
    return text_answer(404, "no image of the camera was heard");
  }
  if (path.starts_with(kSubmapPath))
    if (const auto blob = map_.blob(path.substr(std::string(kSubmapPath).size())))
      return {.type = "application/octet-stream", .body = blob};
  return text_answer(404, "there is nothing of this name");
}

void WebNode::tell_if_new(const char* event, const std::string& data, std::string* told) {
  if (data == *told) return;
  *told = data;
  tell_(event, data);
}

void WebNode::tick(int64_t now_us, bool watched) {
  if (std::exchange(watched_, watched) != watched) told_ = {};  // a new listener has heard nothing yet
  image_.set_watched(watched);
  map_.tick(now_us, watched);
  if (!watched) return;
  tell_if_new("map", map_.map(), &told_.map);
  tell_if_new("timeline", map_.timeline(), &told_.timeline);
  if (is_due(now_us, told_.pose_us, kPoseUs)) {
    told_.pose_us = now_us;
    tell_if_new("pose", json_text(map_.pose()), &told_.pose);
  }
  if (const auto image_us = image_.utime_us();
      image_us != told_.image_us && is_due(now_us, told_.image_told_us, kImageUs)) {
    told_.image_told_us = now_us;
    told_.image_us = image_us;
    tell_("image", json_text(nlohmann::json(*image_us)));
  }
  if (is_due(now_us, told_.status_us, kStatusUs)) {  // also shows the page that the server is alive
    told_.status_us = now_us;
    tell_("status", json_text(nlohmann::ordered_json{{"bus", bus_name_}, {"live", status_.to_json()}}));
  }
}

}  // namespace rumi::tool
