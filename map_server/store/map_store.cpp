// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "base/files/file_access.h"
#include "base/running/log.h"
#include "map_server/store/map_store_schema.h"

namespace rumi::map_server {
namespace {

constexpr int64_t kPagesPerFreeOne = 10;       // more free pages than every tenth are given back to the file system
constexpr int kPagesGivenBack = 256;           // with each save(): it takes the time of writing them
constexpr std::chrono::seconds kStartWait{2};  // for a reader (the sqlite3 tool, a backup) to get out of the way
// Later nobody hears us while we wait, and who is refused sends again.
constexpr std::chrono::milliseconds kSaveWait{20};

}  // namespace

MapStore::MapStore(const std::string& file) : file_(file) {
  if (file_.empty()) throw std::runtime_error("map_server.database is empty; give a file name or :memory:");
  if (file_ != kInMemory) lock_ = DatabaseLock(file_);
  try {
    db_ = Database(file_);
    wait_ = kStartWait;
    db_.wait_for_others(wait_);
    open();
    wait_ = kSaveWait;
    db_.wait_for_others(wait_);
  } catch (const SqliteError& error) {
    throw std::runtime_error(explain(error));
  }
}

MapStore MapStore::copy_in_memory(const std::string& file, std::chrono::milliseconds wait) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(fmt::format("{}: there is no such file", file));
  MapStore store;
  store.file_ = file;  // that errors are about
  store.wait_ = wait;
  try {
    Database original = Database::open_existing(file);
    original.wait_for_others(wait);
    store.db_ = Database(kInMemory);
    store.db_.copy_from(original);
    store.open();
  } catch (const SqliteError& error) {
    throw std::runtime_error(store.explain(error));
  }
  store.file_ = kInMemory;
  return store;
}

void MapStore::open() {
  const int64_t version = db_.integer("PRAGMA user_version");
  const int64_t application = db_.integer("PRAGMA application_id");
  const bool is_new = version == 0 && application == 0 && db_.integer("SELECT count(*) FROM sqlite_master") == 0;
  if (!is_new && application != kMapApplicationId)
    throw std::runtime_error(fmt::format("{} is an SQLite database but no map of ours; give another file", file_));
  if (version > kMapSchemaVersion)
    throw std::runtime_error(fmt::format(
        "{} has schema version {}, written by a newer program; this one knows version {} and leaves the file "
        "as it is: update it or give another file",
        file_, version, kMapSchemaVersion));
  if (const std::string wrong = is_new ? "ok" : db_.text("PRAGMA quick_check(1)"); wrong != "ok")
    throw SqliteError(SQLITE_CORRUPT, wrong);
  if (is_new) db_.execute("PRAGMA auto_vacuum = INCREMENTAL");  // or never
  db_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
  // A readable but not writable file must be refused now, not when the first update comes: hence the transaction, also
  // where there is nothing to do.
  Transaction transaction(db_);
  if (version == kMapSchemaVersion) return;
  if (is_new) {
    db_.execute(kMapSchema);
    db_.execute(kMapSchemaPlacements);
    db_.execute(kMapSchemaLinks);
    db_.execute(kMapSchemaFrames);
    db_.execute(kMapSchemaMasks);
  } else {
    bring_up(version);
    log_info("{} is of schema version {}: it is brought to version {}", file_, version, kMapSchemaVersion);
  }
  db_.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kMapApplicationId, kMapSchemaVersion));
  transaction.commit();
}

void MapStore::bring_up(int64_t version) {
  if (version <= 4) {
    if (version > 1) db_.execute(kMapSchemaFrom4);
    db_.execute(kMapSchemaPlacements);
    if (version > 1) db_.execute(kMapSchemaTo5);
    if (version == 1) {
      db_.execute(kMapSchemaLinks);
      db_.execute(kMapSchemaFrom1To2);
    }
    if (version <= 2) db_.execute(kMapSchemaFrom2To3);
    if (version <= 3) db_.execute(kMapSchemaFrom3To4);
    db_.execute(kMapSchemaPyramids);
  }
  if (version <= 5) {
    db_.execute(kMapSchemaFrom5);
    db_.execute(kMapSchemaFrames);
    db_.execute(kMapSchemaTo6);
  }
  db_.execute(kMapSchemaMasks);
}

std::string MapStore::explain(const SqliteError& error) const {
  const char* what = error.what();
  switch (error.code()) {
    case SQLITE_FULL:
      return fmt::format("cannot write {}: no space left ({}); free some, nothing that was acknowledged is lost", file_,
                         what);
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return fmt::format(
          "cannot write {}: it or its folder is read-only ({}{}); name another file with --set "
          "map_server.database=FILE",
          file_, what, note_on_owner(file_));
    case SQLITE_CANTOPEN:
      return fmt::format("cannot open {}: {}; the folder must exist and be writable", file_, what);
    case SQLITE_NOTADB:
      return fmt::format("{} is not an SQLite database; give another file or move it away", file_);
    case SQLITE_CORRUPT:
      return fmt::format("{} is damaged ({}); move it away, `sqlite3 {} .recover` may save what is left", file_, what,
                         file_);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return explain_busy();
    default:
      return fmt::format("{}: {}", file_, what);
  }
}

std::string MapStore::explain_busy() const {
  const std::optional<std::string> pid = holder_of_lock(DatabaseLock::file_of(file_));
  const std::string who = pid ? fmt::format("a map_server, pid {}, has it open", *pid)
                              : "no map_server has it open; an sqlite3 shell or a backup may";
  return fmt::format(
      "{} is busy: another program has kept it locked for {} s ({}); let that one finish or end it, then "
      "try again",
      file_, std::chrono::duration<double>(wait_).count(), who);
}

int64_t MapStore::stored_revision(SubmapKey key) const {
  const auto it = stored_.find(key);
  return it == stored_.end() ? 0 : it->second.revision;
}

int64_t MapStore::bytes() {
  try {
    bytes_ = db_.integer("PRAGMA page_count") * db_.integer("PRAGMA page_size");
  } catch (const SqliteError&) {
    return bytes_;  // what is wrong is said when the next save() fails
  }
  return bytes_;
}

void MapStore::give_back_pages() {
  try {
    if (db_.integer("PRAGMA freelist_count") * kPagesPerFreeOne > db_.integer("PRAGMA page_count"))
      db_.execute(fmt::format("PRAGMA incremental_vacuum({})", kPagesGivenBack));
  } catch (const SqliteError&) {
    return;  // nothing is lost by it; after the next save() again
  }
}

void MapStore::limit_bytes(int64_t bytes) {
  const int64_t pages = std::max<int64_t>(1, bytes / db_.integer("PRAGMA page_size"));
  db_.execute(fmt::format("PRAGMA max_page_count = {}", pages));
}

int64_t MapStore::changes() const { return sqlite3_total_changes(db_.handle()); }

}  // namespace rumi::map_server
