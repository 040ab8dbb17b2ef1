// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "base/files/free_space.h"
#include "base/running/log.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t kRoomBytes = 64'000'000;  // enough for COLMAP's database and models of a window

// Returns 0 if the free space cannot be determined.
uintmax_t free_bytes(const std::string& folder) { return free_space(folder).value_or(0); }

std::string why_not_chosen(const std::string& folder) {
  const std::string why = why_unusable(folder);
  return why.empty() ? fmt::format("has {:.1f} MB free", 1e-6 * static_cast<double>(free_bytes(folder))) : why;
}

void tell_once(const std::string& wanted, const std::string& chosen) {
  static std::atomic<bool> told = false;
  if (wanted.empty() || wanted == chosen || told.exchange(true)) return;
  log_warning("TMPDIR={} {}: temporary files go to {}", wanted, why_not_chosen(wanted), chosen);
}

}  // namespace

std::string why_unusable(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return "is not there";
  if (!fs::is_directory(folder, error)) return "is no folder";
  if (access(folder.c_str(), W_OK | X_OK) != 0) return fmt::format("cannot be written to: {}", std::strerror(errno));
  return {};
}

std::string scratch_folder(const std::string& also) {
  const char* variable = std::getenv("TMPDIR");
  const std::string wanted = variable ? variable : "";
  std::string best;
  std::vector<std::string> tried;
  for (const std::string& folder : {wanted, std::string("/tmp"), std::string("/var/tmp"), also, std::string(".")}) {
    if (folder.empty()) continue;
    tried.push_back(fmt::format("{} {}", folder, why_not_chosen(folder)));
    if (!why_unusable(folder).empty()) continue;
    if (best.empty() || free_bytes(folder) > free_bytes(best)) best = folder;
    if (free_bytes(best) >= kRoomBytes) break;
  }
  if (best.empty() || free_bytes(best) == 0)
    throw std::runtime_error(
        fmt::format("no folder for temporary files: {}; name one with TMPDIR=FOLDER in front of "
                    "the command",
                    fmt::join(tried, ", ")));
  tell_once(wanted, best);
  return best;
}

}  // namespace rumi
