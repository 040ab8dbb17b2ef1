// SPDX-License-Identifier: BSD-3-Clause
// Says why bytes do not decode as a message of type T. A message begins with the fingerprint of its type, which tells
// another version of the type from damage.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>

namespace rumi {

template <class T>
std::string why_undecodable(std::span<const uint8_t> data) {
  if (data.size() < sizeof(uint64_t)) return fmt::format("{} bytes are no {}", data.size(), T::getTypeName());
  uint64_t fingerprint = 0;
  for (const uint8_t byte : data.first(sizeof(uint64_t))) fingerprint = fingerprint << 8 | byte;
  const auto ours = static_cast<uint64_t>(T::getHash());
  if (fingerprint == ours) return fmt::format("it is a damaged {}", T::getTypeName());
  return fmt::format(
      "it is no {} of this version: its fingerprint is {:#018x}, this program reads {:#018x}; use the program that "
      "wrote "
      "it",
      T::getTypeName(), fingerprint, ours);
}

}  // namespace rumi
