// SPDX-License-Identifier: BSD-3-Clause
// Repairs times that some programs write wrongly, and says so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rumi {

// Gives decimals their leading zeros if a program wrote "5.33333" for 5.033333: the second, a point, and the count of
// microseconds (or milli- or nanoseconds). Recognized by decimals of unequal length that give even steps only if they
// are read as counts. Returns a note for the user, or an empty string.
std::string give_decimals_their_zeros(std::vector<std::string>* times);

// Repairs times that are microseconds of a 32-bit counter, which begins again at 0 after 71 minutes: adds 2^32 to those
// that follow. The times are in stored order. Returns a note for the user, or an empty string.
std::string continue_32_bits(std::vector<std::string>* times);
// As continue_32_bits(), for times in any order: a gap of more than half the range of 32 bits shows where the counter
// begins again.
std::string continue_sorted_32_bits(std::vector<std::string>* times);

// Returns a message that names the first negative time, if all times are negative, or more than four (a few may just be
// wrong); else an empty string.
std::string why_negative(const std::vector<int64_t>& utimes_us);

}  // namespace rumi
