// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/sqlite.h"

#include <cerrno>
#include <utility>

#include "base/this_process/account_limits.h"

namespace rumi {

Database::Database(const std::string& file) : Database(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE) {}

Database Database::open_existing(const std::string& file) { return {file, SQLITE_OPEN_READWRITE}; }

Database Database::open_to_read(const std::string& file) { return {file, SQLITE_OPEN_READONLY}; }

Database::Database(const std::string& file, int flags) {
  const int code = sqlite3_open_v2(file.c_str(), &db_, flags, nullptr);
  if (code == SQLITE_OK) return;
  const std::string what = db_ ? sqlite3_errmsg(db_) : "out of memory";
  sqlite3_close(db_);  // the destructor does not run when a constructor throws
  db_ = nullptr;
  throw SqliteError(code & 0xff, what);
}

Database::~Database() { sqlite3_close_v2(db_); }

Database::Database(Database&& other) noexcept : db_(std::exchange(other.db_, nullptr)) {}

Database& Database::operator=(Database&& other) noexcept {
  std::swap(db_, other.db_);
  return *this;
}

void Database::wait_for_others(std::chrono::milliseconds time) {
  sqlite3_busy_timeout(db_, static_cast<int>(time.count()));
}

void Database::copy_from(Database& other) {
  sqlite3_backup* backup = sqlite3_backup_init(db_, "main", other.db_, "main");
  if (!backup) fail(sqlite3_errcode(db_));
  const int step = sqlite3_backup_step(backup, -1);
  const int end = sqlite3_backup_finish(backup);
  if (end != SQLITE_OK) fail(end);
  // SQLite does not count a busy database as a failure, because the backup could go on later. So only the step's code
  // says that the copy is not complete.
  if (step != SQLITE_DONE) throw SqliteError(step & 0xff, sqlite3_errstr(step));
}

void Database::fail(int code) const {
  // SQLite only says "disk I/O error", and forgets the errno if it rolls back. Then a limit of file sizes is the likely
  // cause.
  if ((code & 0xff) == SQLITE_IOERR) {
    const int reason = sqlite3_system_errno(db_);
    if (reason != 0 || may_be_too_large()) throw SqliteError(code & 0xff, write_error_text(reason ? reason : EFBIG));
  }
  throw SqliteError(code & 0xff, sqlite3_errmsg(db_));
}

void Database::execute(const std::string& sql) {
  const int code = sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

int64_t Database::integer(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string Database::text(const std::string& sql) {
  Statement statement(*this, sql);
  if (!statement.step()) return {};
  const std::span<const uint8_t> bytes = statement.blob(0);
  return {bytes.begin(), bytes.end()};
}

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  check(sqlite3_prepare_v2(database.handle(), sql.c_str(), static_cast<int>(sql.size()), &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::check(int code) const {
  if (code != SQLITE_OK) database_.fail(code);
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  database_.fail(code);
}

void Statement::run() {
  while (step()) {
  }
  sqlite3_reset(statement_);
}

std::span<const uint8_t> Statement::blob(int column) const {
  const auto* data = static_cast<const uint8_t*>(sqlite3_column_blob(statement_, column));
  return {data, static_cast<size_t>(sqlite3_column_bytes(statement_, column))};
}

void Statement::bind_one(int index, int64_t value) { check(sqlite3_bind_int64(statement_, index, value)); }
void Statement::bind_one(int index, double value) { check(sqlite3_bind_double(statement_, index, value)); }
void Statement::bind_one(int index, const std::optional<double>& value) {
  check(value ? sqlite3_bind_double(statement_, index, *value) : sqlite3_bind_null(statement_, index));
}
void Statement::bind_one(int index, const std::string& value) {
  check(sqlite3_bind_text64(statement_, index, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}
void Statement::bind_one(int index, std::span<const uint8_t> value) {
  // A null pointer would bind NULL instead of an empty blob.
  if (value.empty()) return check(sqlite3_bind_zeroblob(statement_, index, 0));
  check(sqlite3_bind_blob64(statement_, index, value.data(), value.size(), SQLITE_STATIC));
}

Transaction::Transaction(Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  // On a full disk SQLite ends the transaction by itself; then there is nothing to roll back.
  if (sqlite3_get_autocommit(database_.handle()) == 0)
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() { database_.execute("COMMIT"); }

}  // namespace rumi
