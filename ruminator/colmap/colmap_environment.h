// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace rumi::ruminator {

// COLMAP contains Qt, which looks for a display even if it shows nothing. Its log must not leave files in /tmp.
inline std::vector<std::string> colmap_environment() { return {"QT_QPA_PLATFORM=offscreen", "GLOG_logtostderr=1"}; }

// True if `text` contains `what`. Ignores case, because programs write their messages in upper and in lower case.
inline bool contains_any_case(std::string_view text, std::string_view what) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), what.begin(), what.end(), same) != text.end();
}

}  // namespace rumi::ruminator
