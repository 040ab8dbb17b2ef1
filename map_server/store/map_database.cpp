// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_database.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/files/file_access.h"
#include "base/running/log.h"
#include "map_server/store/map_migrations.h"
#include "map_server/store/map_schema.h"

namespace rumi::map_server {
namespace {

constexpr int64_t kPagesPerFreeOne = 10;  // free pages are returned if more than one page in ten is free
constexpr int kPagesGivenBack = 256;      // free pages returned at a time; returning them takes as long as writing them
constexpr std::chrono::seconds kStartWait{2};  // at the start, other programs may keep the file locked this long
// After the start the wait is short: map_server does not answer meanwhile, and a sender that is refused sends again.
constexpr std::chrono::milliseconds kSaveWait{20};

}  // namespace

Result<MapDatabase> MapDatabase::open(const std::string& file) {
  if (file.empty()) return Error{"map_server.database is empty; give a file name or :memory:"};
  MapDatabase database;
  database.file_ = file;
  if (!database.is_in_memory()) {
    Result<DatabaseLock> lock = DatabaseLock::take(file);
    if (!lock) return lock.error();
    database.lock_ = std::move(*lock);
  }
  try {
    // SQLite writes what its cache cannot hold of a database without a name to a file without a name.
    database.db_ = Database(database.is_in_memory() ? "" : file);
    database.wait_ = kStartWait;
    database.db_.wait_for_others(database.wait_);
    if (const Result<> ours = database.bring_to_our_version(); !ours) return ours.error();
    database.wait_ = kSaveWait;
    database.db_.wait_for_others(database.wait_);
  } catch (const SqliteError& error) {
    return database.explain(error);
  }
  return database;
}

Result<MapDatabase> MapDatabase::copy_in_memory(const std::string& file, std::chrono::milliseconds wait) {
  if (!std::filesystem::is_regular_file(file)) return Error{.what = "there is no such file", .where = file};
  MapDatabase copy;
  copy.file_ = file;  // so that errors name the original
  copy.wait_ = wait;
  try {
    Database original = Database::open_existing(file);
    original.wait_for_others(wait);
    copy.db_ = Database(kInMemory);
    copy.db_.copy_from(original);
    if (const Result<> ours = copy.bring_to_our_version(); !ours) return ours.error();
  } catch (const SqliteError& error) {
    return copy.explain(error);
  }
  copy.file_ = kInMemory;
  return copy;
}

Result<> MapDatabase::bring_to_our_version() {
  const int64_t version = db_.integer("PRAGMA user_version");
  const int64_t application = db_.integer("PRAGMA application_id");
  const bool is_new = version == 0 && application == 0 && db_.integer("SELECT count(*) FROM sqlite_master") == 0;
  if (!is_new && application != kMapApplicationId)
    return Error{.what = fmt::format("{} is an SQLite database but no map of ours", file_),
                 .remedy = "give another file"};
  if (version > kMapSchemaVersion)
    return Error{fmt::format(
        "{} has schema version {}, written by a newer program; this one knows version {} and leaves the file "
        "as it is: update it or give another file",
        file_, version, kMapSchemaVersion)};
  if (const std::string wrong = is_new ? "ok" : db_.text("PRAGMA quick_check(1)"); wrong != "ok")
    throw SqliteError(SQLITE_CORRUPT, wrong);
  if (is_new) db_.execute("PRAGMA auto_vacuum = INCREMENTAL");  // cannot be set later
  db_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
  // Begins a transaction even if there is nothing to do: it fails now if the file is read-only, and not only when the
  // first update comes.
  Transaction transaction(db_);
  if (version == kMapSchemaVersion) return {};
  make_or_migrate(is_new, version);
  transaction.commit();
  return {};
}

void MapDatabase::make_or_migrate(bool is_new, int64_t version) {
  if (is_new) {
    create_map_tables(db_);
  } else {
    migrate_map(db_, version);
    log_info("{} is of schema version {}: it is brought to version {}", file_, version, kMapSchemaVersion);
  }
  db_.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kMapApplicationId, kMapSchemaVersion));
}

Error MapDatabase::explain(const SqliteError& error) const {
  const char* what = error.what();
  switch (error.code()) {
    case SQLITE_FULL:
      return {.what = fmt::format("cannot write {}: no space left ({})", file_, what),
              .remedy = "free some, nothing that was acknowledged is lost"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {.what = fmt::format("cannot write {}: it or its folder is read-only ({}{})", file_, what,
                                  note_on_owner(file_)),
              .remedy = "name another file with --set map_server.database=FILE"};
    case SQLITE_CANTOPEN:
      return {.what = fmt::format("cannot open {}: {}", file_, what),
              .remedy = "the folder must exist and be writable"};
    case SQLITE_NOTADB:
      return {.what = fmt::format("{} is not an SQLite database", file_),
              .remedy = "give another file or move it away"};
    case SQLITE_CORRUPT:
      return {.what = fmt::format("{} is damaged ({})", file_, what),
              .remedy = fmt::format("move it away, `sqlite3 {} .recover` may save what is left", file_)};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return explain_busy();
    default:
      return {.what = what, .where = file_};
  }
}

Error MapDatabase::explain_busy() const {
  const std::optional<std::string> pid = holder_of_lock(DatabaseLock::file_of(file_));
  const std::string who = pid ? fmt::format("a map_server, pid {}, has it open", *pid)
                              : "no map_server has it open; an sqlite3 shell or a backup may";
  return {.what = fmt::format("{} is busy: another program has kept it locked for {} s ({})", file_,
                              std::chrono::duration<double>(wait_).count(), who),
          .remedy = "let that one finish or end it, then try again"};
}

int64_t MapDatabase::bytes() {
  try {
    bytes_ = db_.integer("PRAGMA page_count") * db_.integer("PRAGMA page_size");
  } catch (const SqliteError&) {
    return bytes_;  // the next save() reports the error
  }
  return bytes_;
}

int64_t MapDatabase::changes() const { return sqlite3_total_changes(db_.handle()); }

void MapDatabase::limit_bytes(int64_t bytes) {
  const int64_t pages = std::max<int64_t>(1, bytes / db_.integer("PRAGMA page_size"));
  db_.execute(fmt::format("PRAGMA max_page_count = {}", pages));
}

void MapDatabase::give_back_pages() {
  try {
    if (db_.integer("PRAGMA freelist_count") * kPagesPerFreeOne > db_.integer("PRAGMA page_count"))
      db_.execute(fmt::format("PRAGMA incremental_vacuum({})", kPagesGivenBack));
  } catch (const SqliteError&) {
    return;  // harmless, the next save() tries again
  }
}

}  // namespace rumi::map_server
