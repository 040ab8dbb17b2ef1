// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/channel_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rumi {

std::string list_of_channels(const std::vector<std::pair<std::string, int64_t>>& messages_on) {
  constexpr size_t kMostNamed = 8;
  std::vector<std::string> names;
  for (const auto& [channel, messages] : messages_on)
    if (names.size() < kMostNamed) names.push_back(fmt::format("{} ({})", channel, messages));
  if (messages_on.size() > kMostNamed) names.push_back(fmt::format("{} more", messages_on.size() - kMostNamed));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string advice_on_channels(const std::vector<std::pair<std::string, int64_t>>& images_on, const std::string& best) {
  return fmt::format(
      "it has images on {0}: name one with --set camera_driver.log_channel={1} (`rumi calibrate`: -c {1})",
      list_of_channels(images_on), best);
}

}  // namespace rumi
