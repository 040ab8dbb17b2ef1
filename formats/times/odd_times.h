// SPDX-License-Identifier: BSD-3-Clause
// Repairs times that some programs write wrongly, and says so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rumi {

// "5.33333" for 5.033333: microseconds (or others) behind the second without leading zeros. Found by decimals of
// unequal length, with which the times are even only if they are counts. Gives them their zeros; returns what to say,
// or an empty string.
std::string give_decimals_their_zeros(std::vector<std::string>* times);

// Microseconds of a counter with 32 bits that begins again at 0 after 71 minutes, in the order in which they are
// stored.
std::string continue_32_bits(std::vector<std::string>* times);
// Continues the counter in the order of the numbers: a gap is more than half of the range of 32 bits.
std::string continue_sorted_32_bits(std::vector<std::string>* times);

// Says that times are negative, with the first one, if all of them are, or more than the few that may be wrong; else
// empty.
std::string why_negative(const std::vector<int64_t>& utimes_us);

}  // namespace rumi
