# SPDX-License-Identifier: BSD-3-Clause
# lcm-gen 1.3 trusts the lengths in a message: `v.resize(n)` with a hostile n throws or exhausts memory before the
# truncation is noticed, and a string of length 0 reads npos bytes. This changes the generated decoders: if the bytes
# that are left cannot hold the length, the message is broken.
set(helper [=[
#ifndef RUMI_LCM_LENGTH_FITS
#define RUMI_LCM_LENGTH_FITS
#include <stdint.h>
#include <type_traits>
#include <vector>
namespace rumi {
// Fewest bytes that an element takes on the wire: numbers always the same, structs with all their arrays empty.
template <class T>
typename std::enable_if<std::is_arithmetic<T>::value, int>::type lcm_min_size() { return sizeof(T); }
template <class T>
typename std::enable_if<std::is_class<T>::value, int>::type lcm_min_size() { return T()._getEncodedSizeNoHash(); }
template <class T>
bool lcm_length_fits(int32_t n, int bytes_left, const std::vector<T>&) {
  return n >= 0 && n <= bytes_left / lcm_min_size<T>();
}
}  // namespace rumi
#endif
]=])

file(GLOB headers ${DIR}/*.hpp)
foreach(header ${headers})
  file(READ ${header} text)
  string(REGEX REPLACE "(this->[^\n;]*)\\.resize\\((this->[A-Za-z0-9_]+)\\);"
         "if (!lcm_length_fits(\\2, maxlen - pos, \\1)) return -1; \\1.resize(\\2);" text "${text}")
  string(REGEX REPLACE "if\\((__[A-Za-z0-9_]*len_*) > maxlen - pos\\) return -1;"
         "if (\\1 < 1 || \\1 > maxlen - pos) return -1;" text "${text}")
  string(REPLACE "#include <lcm/lcm_coretypes.h>\n" "#include <lcm/lcm_coretypes.h>\n\n${helper}" text "${text}")
  file(WRITE ${header} "${text}")
endforeach()
