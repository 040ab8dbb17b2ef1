// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace rumi::ruminator {

// Qt is a part of COLMAP even where it shows nothing, and looks for a display. Its log would leave files in /tmp.
inline std::vector<std::string> colmap_environment() { return {"QT_QPA_PLATFORM=offscreen", "GLOG_logtostderr=1"}; }

// What programs say, they say in upper and in lower case.
inline bool contains_any_case(std::string_view text, std::string_view what) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), what.begin(), what.end(), same) != text.end();
}

}  // namespace rumi::ruminator
