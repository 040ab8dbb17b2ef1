// SPDX-License-Identifier: BSD-3-Clause
// Repairs times that some programs write wrongly, and says so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rumi {

// Gives decimals their leading zeros where a program wrote "5.33333" for 5.033333, microseconds (or others) behind the
// second. Recognized by decimals of unequal length, with which the times are even only if they are counts. Returns what
// to tell the user, or an empty string.
std::string give_decimals_their_zeros(std::vector<std::string>* times);

// Continues times, in the order in which they are stored, that are microseconds of a 32-bit counter, which begins again
// at 0 after 71 minutes.
std::string continue_32_bits(std::vector<std::string>* times);
// Continues the counter in the order of the numbers: a gap is more than half of the range of 32 bits.
std::string continue_sorted_32_bits(std::vector<std::string>* times);

// Says that times are negative, with the first one, if all of them are, or more than the few that may be wrong; else
// empty.
std::string why_negative(const std::vector<int64_t>& utimes_us);

}  // namespace rumi
