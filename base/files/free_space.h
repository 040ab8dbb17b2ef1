// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace rumi {

// Returns the bytes that may still be written to the folder's disk; nullopt if that cannot be found out.
inline std::optional<uintmax_t> free_space(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? std::nullopt : std::optional(space.available);
}

}  // namespace rumi
