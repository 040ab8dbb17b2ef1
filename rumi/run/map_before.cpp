// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/map_before.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <stdexcept>

#include "base/files/sqlite.h"
#include "map_server/store/map_store.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

// "map.db", "-20261128-101500": "map-20261128-101500.db".
fs::path with_tag(const fs::path& file, const std::string& tag) {
  return file.parent_path() / (file.stem().string() + tag + file.extension().string());
}

bool is_there(const fs::path& file) {
  std::error_code code;
  return fs::exists(file, code);
}

void give_name(const fs::path& from, const fs::path& to) {
  std::error_code code;
  if (is_there(to)) code = std::make_error_code(std::errc::file_exists);
  if (!code) fs::rename(from, to, code);
  if (code)
    throw std::runtime_error(
        fmt::format("{}: cannot be renamed to {}: {}", from.string(), to.string(), code.message()));
}

}  // namespace

std::optional<std::string> describe_map_before(const std::string& database) {
  if (!is_there(database)) return std::nullopt;
  try {
    Database map = Database::open_existing(database);
    const int64_t frames = map.integer("SELECT count(*) FROM frames");
    const int64_t sessions = map.integer("SELECT count(DISTINCT session) FROM frames");
    if (frames == 0) return std::nullopt;
    return fmt::format("{} frames of {}", frames,
                       sessions == 1 ? "an earlier session" : fmt::format("{} earlier sessions", sessions));
  } catch (const SqliteError&) {
    const auto readable = map_server::MapStore::copy_in_memory(database);
    if (!readable) throw std::runtime_error(readable.error().text());
    return std::nullopt;
  }
}

std::string set_aside(const std::string& database, const std::string& spool) {
  const std::time_t now = std::time(nullptr);
  const std::string tag = fmt::format("-{:%Y%m%d-%H%M%S}", fmt::localtime(now));
  const fs::path map = with_tag(database, tag);
  const bool has_map = is_there(database);
  // SQLite finds what belongs to a file by its name.
  for (const char* part : {"", "-wal", "-shm"})
    if (is_there(database + part)) give_name(database + part, map.string() + part);
  if (!spool.empty() && is_there(spool)) give_name(spool, with_tag(spool, tag));
  return has_map ? map.string() : "";
}

}  // namespace rumi::tool
