// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/map_before.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

#include "base/files/sqlite.h"
#include "map_server/store/map_store.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

// Returns "map-20261128-101500.db" for "map.db" and "-20261128-101500".
fs::path with_tag(const fs::path& file, const std::string& tag) {
  return file.parent_path() / (file.stem().string() + tag + file.extension().string());
}

bool is_there(const fs::path& file) {
  std::error_code code;
  return fs::exists(file, code);
}

Result<> give_name(const fs::path& from, const fs::path& to) {
  std::error_code code;
  if (is_there(to)) code = std::make_error_code(std::errc::file_exists);
  if (!code) fs::rename(from, to, code);
  if (code) return Error{fmt::format("cannot be renamed to {}: {}", to.string(), code.message()), from.string()};
  return {};
}

}  // namespace

Result<std::string> describe_map_before(const std::string& database) {
  if (!is_there(database)) return "";
  try {
    Database map = Database::open_existing(database);
    const int64_t frames = map.integer("SELECT count(*) FROM frames");
    const int64_t sessions = map.integer("SELECT count(DISTINCT session) FROM frames");
    if (frames == 0) return "";
    return fmt::format("{} frames of {}", frames,
                       sessions == 1 ? "an earlier session" : fmt::format("{} earlier sessions", sessions));
  } catch (const SqliteError&) {
    if (const auto readable = map_server::MapStore::copy_in_memory(database); !readable) return readable.error();
    return "";
  }
}

Result<std::string> set_aside(const std::string& database, const std::string& spool) {
  const std::time_t now = std::time(nullptr);
  const std::string tag = fmt::format("-{:%Y%m%d-%H%M%S}", fmt::localtime(now));
  const fs::path map = with_tag(database, tag);
  const bool has_map = is_there(database);
  // SQLite finds the other files of a database by their names.
  for (const char* part : {"", "-wal", "-shm"})
    if (is_there(database + part))
      if (const Result<> given = give_name(database + part, map.string() + part); !given) return given.error();
  if (!spool.empty() && is_there(spool))
    if (const Result<> given = give_name(spool, with_tag(spool, tag)); !given) return given.error();
  return has_map ? map.string() : "";
}

}  // namespace rumi::tool
