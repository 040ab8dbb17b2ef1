// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/video_controls.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/text/number_text.h"

namespace rumi::camera_driver {
namespace {

constexpr int kMostControls = 1000, kMostMenuItems = 256;
constexpr double kExposureUnitsPerMs = 10;  // V4L2_CID_EXPOSURE_ABSOLUTE counts 100 us

std::string control_name(const __u8* field, size_t size) {
  std::string name;
  for (size_t i = 0; i < size && field[i] != 0; ++i) {
    const char c = static_cast<char>(std::tolower(field[i]));
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain) name += c;
    if (!plain && !name.empty() && name.back() != '_') name += '_';
  }
  while (name.ends_with('_')) name.pop_back();
  return name;
}

std::vector<std::pair<int64_t, std::string>> menu_of(const VideoDevice& device, const v4l2_queryctrl& query) {
  std::vector<std::pair<int64_t, std::string>> menu;
  const int64_t last = std::min<int64_t>(query.maximum, int64_t{query.minimum} + kMostMenuItems);
  for (int64_t index = query.minimum; index <= last; ++index) {
    v4l2_querymenu item{};
    item.id = query.id;
    item.index = static_cast<uint32_t>(index);
    if (device.ioctl(VIDIOC_QUERYMENU, &item) != 0) continue;  // menus may have gaps
    const bool number = query.type == V4L2_CTRL_TYPE_INTEGER_MENU;
    const char* begin = reinterpret_cast<const char*>(item.name);
    menu.emplace_back(index,
                      number ? std::to_string(item.value) : std::string(begin, strnlen(begin, sizeof(item.name))));
  }
  return menu;
}

VideoControl describe_control(const VideoDevice& device, const v4l2_queryctrl& query) {
  VideoControl control{query.id,
                       control_name(query.name, sizeof(query.name)),
                       query.minimum,
                       query.maximum,
                       query.step,
                       query.default_value,
                       {},
                       true};
  const bool is_menu = query.type == V4L2_CTRL_TYPE_MENU || query.type == V4L2_CTRL_TYPE_INTEGER_MENU;
  if (is_menu) control.menu = menu_of(device, query);
  const bool number = is_menu || query.type == V4L2_CTRL_TYPE_INTEGER || query.type == V4L2_CTRL_TYPE_BOOLEAN ||
                      query.type == V4L2_CTRL_TYPE_BITMASK || query.type == V4L2_CTRL_TYPE_BUTTON;
  control.settable = number && !(query.flags & V4L2_CTRL_FLAG_READ_ONLY);
  return control;
}

// Sets controls of a device. `problems` says which could not be set, and why.
class Setter {
 public:
  explicit Setter(const VideoDevice& device) : device_(device), controls_(controls_of(device)) {}

  const VideoControl* find(uint32_t id) const {
    const auto it =
        std::find_if(controls_.begin(), controls_.end(), [id](const VideoControl& c) { return c.id == id; });
    return it == controls_.end() ? nullptr : &*it;
  }
  bool has_choice(uint32_t id, int32_t value) const {
    const VideoControl* control = find(id);
    return control && std::any_of(control->menu.begin(), control->menu.end(),
                                  [value](const auto& item) { return item.first == value; });
  }
  void set(uint32_t id, int64_t value, const std::string& option) {
    if (const VideoControl* control = find(id)) return set(*control, value, option);
    problems.push_back(fmt::format("{}: the camera has no such control", option));
  }
  void set_if_there(uint32_t id, int64_t value, const std::string& option) {
    if (const VideoControl* control = find(id)) set(*control, value, option);
  }
  void set_named(const std::string& name, int64_t value) {
    for (const VideoControl& control : controls_)
      if (control.name == name) return set(control, value, "controls");
    problems.push_back(
        fmt::format("controls: the camera has no '{}' (`rumi camera_driver --list` shows what it has)", name));
  }
  std::vector<std::string> problems;

 private:
  void set(const VideoControl& control, int64_t value, const std::string& option) {
    const auto complain = [&](const std::string& why) {
      problems.push_back(fmt::format("{}: {} cannot be set to {}: {}", option, control.name, value, why));
    };
    if (!control.settable) return complain("it cannot be set at all");
    if (value < control.min || value > control.max)
      return complain(fmt::format("must be {} to {}", control.min, control.max));
    v4l2_control request{control.id, static_cast<int32_t>(value)};
    if (const int result = device_.ioctl(VIDIOC_S_CTRL, &request); result < 0) return complain(std::strerror(-result));
  }
  const VideoDevice& device_;
  std::vector<VideoControl> controls_;
};

void set_exposure(Setter& setter, const std::string& value) {
  if (value == "auto") {
    const bool full = setter.has_choice(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_AUTO);
    setter.set(V4L2_CID_EXPOSURE_AUTO, full ? V4L2_EXPOSURE_AUTO : V4L2_EXPOSURE_APERTURE_PRIORITY, "exposure");
    // Keeps the rate: otherwise many cameras halve it in the dark.
    return setter.set_if_there(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, "exposure");
  }
  setter.set_if_there(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "exposure");
  setter.set(V4L2_CID_EXPOSURE_ABSOLUTE, std::llround(std::stod(value) * kExposureUnitsPerMs), "exposure");
}

// "auto" turns `automatic` on; a number turns it off and sets `manual`.
void set_either(Setter& setter, const std::string& option, const std::string& value, uint32_t automatic,
                uint32_t manual) {
  if (value == "auto") return setter.set(automatic, 1, option);
  setter.set_if_there(automatic, 0, option);
  setter.set(manual, std::llround(std::stod(value)), option);
}

}  // namespace

std::vector<VideoControl> controls_of(const VideoDevice& device) {
  std::vector<VideoControl> controls;
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (int i = 0; i < kMostControls && device.ioctl(VIDIOC_QUERYCTRL, &query) == 0; ++i) {
    const bool heading = query.type == V4L2_CTRL_TYPE_CTRL_CLASS;
    if (!heading && !(query.flags & V4L2_CTRL_FLAG_DISABLED)) controls.push_back(describe_control(device, query));
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return controls;
}

std::optional<int32_t> read_control(const VideoDevice& device, uint32_t id) {
  v4l2_control request{id, 0};
  if (device.ioctl(VIDIOC_G_CTRL, &request) != 0) return std::nullopt;
  return request.value;
}

std::vector<std::string> apply_controls(const VideoDevice& device, const CameraControls& controls) {
  Setter setter(device);
  if (!controls.exposure.empty()) set_exposure(setter, controls.exposure);
  if (!controls.gain.empty()) set_either(setter, "gain", controls.gain, V4L2_CID_AUTOGAIN, V4L2_CID_GAIN);
  if (!controls.white_balance.empty())
    set_either(setter, "white_balance", controls.white_balance, V4L2_CID_AUTO_WHITE_BALANCE,
               V4L2_CID_WHITE_BALANCE_TEMPERATURE);
  if (!controls.focus.empty())
    set_either(setter, "focus", controls.focus, V4L2_CID_FOCUS_AUTO, V4L2_CID_FOCUS_ABSOLUTE);
  if (!controls.power_line.empty()) {
    const std::string& choice = controls.power_line;
    const int value = choice == "off"  ? V4L2_CID_POWER_LINE_FREQUENCY_DISABLED
                      : choice == "50" ? V4L2_CID_POWER_LINE_FREQUENCY_50HZ
                      : choice == "60" ? V4L2_CID_POWER_LINE_FREQUENCY_60HZ
                                       : V4L2_CID_POWER_LINE_FREQUENCY_AUTO;
    setter.set(V4L2_CID_POWER_LINE_FREQUENCY, value, "power_line");
  }
  if (const Result<ControlList> list = parse_control_list(controls.controls))  // the options were checked
    for (const auto& [name, value] : *list) setter.set_named(name, value);
  return setter.problems;
}

std::string lock_automatic(const VideoDevice& device) {
  Setter setter(device);
  std::string done;
  // The values are read before the automatic control is turned off, while they are what it chose.
  const auto lock = [&](uint32_t automatic, int32_t off, uint32_t manual, const char* what) {
    const std::optional<int32_t> value = read_control(device, manual), mode = read_control(device, automatic);
    if (!value || !mode || *mode == off) return;
    const size_t before = setter.problems.size();
    setter.set(automatic, off, what);
    setter.set(manual, *value, what);
    if (setter.problems.size() == before) done += fmt::format("{}{} {}", done.empty() ? "" : ", ", what, *value);
  };
  lock(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, V4L2_CID_EXPOSURE_ABSOLUTE, "exposure");
  lock(V4L2_CID_AUTOGAIN, 0, V4L2_CID_GAIN, "gain");
  lock(V4L2_CID_AUTO_WHITE_BALANCE, 0, V4L2_CID_WHITE_BALANCE_TEMPERATURE, "white balance");
  std::string text = done.empty() ? "nothing is automatic that could be locked" : "locked: " + done;
  for (const std::string& problem : setter.problems) text += "; " + problem;
  return text;
}

Result<ControlList> parse_control_list(const std::string& text) {
  ControlList list;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    std::string item = text.substr(begin, end - begin);
    std::erase(item, ' ');
    begin = end + 1;
    const size_t equals = item.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parse_number<int32_t>(item.substr(equals + 1));
    if (equals == 0 || !value)
      return Error{fmt::format("controls has '{}': expected NAME=NUMBER, NAME=NUMBER, ...", item)};
    list.emplace_back(item.substr(0, equals), *value);
  }
  return list;
}

}  // namespace rumi::camera_driver
