// SPDX-License-Identifier: BSD-3-Clause
// Finds the unit of the times in a list, by the image rate that each unit would give. Recorders write microseconds or
// milliseconds where a format asks for seconds or nanoseconds.
#pragma once

#include <string>
#include <vector>

#include "formats/times/timestamps.h"

namespace rumi {

struct ChosenUnit {
  TimeUnit unit = TimeUnit::kSeconds;
  std::string note;  // which unit was chosen against the format, and why; may be empty
};

// Chooses `usual` if it gives a rate that a camera can have, else the unit whose rate is nearest to that of a usual
// camera; `usual` also if no unit gives such a rate. `times`: decimal numbers, in any order.
ChosenUnit choose_time_unit(const std::vector<std::string>& times, TimeUnit usual);

}  // namespace rumi
