// SPDX-License-Identifier: BSD-3-Clause
// Reads times in the names of image files.
#pragma once

#include <string>
#include <vector>

#include "formats/times/timestamps.h"

namespace rumi {

struct FileNameTimes {
  std::vector<std::string> times;  // a decimal number for each name; an empty text if the name has no time
  TimeUnit usual = TimeUnit::kSeconds;
  bool count_within_second = false;  // what looks like decimals counts the images of each second (_000, _001 ...)
  bool have_another_order = false;   // the order of the times may differ from that of the names: sort by time
  std::string note;                  // empty, or how odd times are read
};

// Reads times such as "1305031102.175304" (seconds, at least three decimals, or nine digits before them),
// "1403636579763555584" (seconds to nanoseconds, at least ten digits and no 0 before them; other whole numbers only
// count the images), "2026-03-02_10-15-00.250" (UTC) and "10-15-00.250" (time of day), with any text before and after.
// Uses the kind of time that most names have. If times of day leave a gap of more than half a day, they pass midnight.
FileNameTimes times_in_names(const std::vector<std::string>& names);

// True for hexadecimal numbers, "0000000a.jpg" after "00000009.jpg": the names have one length and one beginning, some
// have letters up to f, and others digits alone.
bool are_hexadecimal(const std::vector<std::string>& names);

}  // namespace rumi
