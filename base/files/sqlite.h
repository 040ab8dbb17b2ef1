// SPDX-License-Identifier: BSD-3-Clause
// SQLite's C interface as classes that own their handles. Failures throw SqliteError; callers turn it into a message
// for the user.
#pragma once

#include <sqlite3.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rumi {

class SqliteError : public std::runtime_error {
 public:
  SqliteError(int code, const std::string& what) : std::runtime_error(what), code_(code) {}
  int code() const { return code_; }  // SQLITE_FULL, SQLITE_CORRUPT, ... (primary code)

 private:
  int code_;
};

class Database {
 public:
  Database() = default;
  // Opens the file, or creates it. ":memory:" is a database in memory that ends with the object.
  explicit Database(const std::string& file);
  // Opens an existing file; read-only if there is no permission to write it.
  static Database open_existing(const std::string& file);
  // Opens an existing file read-only.
  static Database open_to_read(const std::string& file);
  // Sets how long to wait if other processes have locked the file; by default not at all.
  void wait_for_others(std::chrono::milliseconds time);
  // Replaces all contents by those of `other`. Waits for locks as long as `other` does.
  void copy_from(Database& other);
  ~Database();
  Database(Database&& other) noexcept;
  Database& operator=(Database&& other) noexcept;

  sqlite3* handle() const { return db_; }
  void execute(const std::string& sql);
  int64_t integer(const std::string& sql);  // returns the first column of the first row, 0 if there is no row
  std::string text(const std::string& sql);
  [[noreturn]] void fail(int code) const;

 private:
  Database(const std::string& file, int flags);

  sqlite3* db_ = nullptr;
};

// A prepared statement: `insert.bind(a, b, c).run()` or `select.bind(a); while (select.step()) ... select.integer(0)`.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Binds all parameters in order and makes the statement ready to run again. Blobs are not copied: they must outlive
  // the next step().
  template <class... Args>
  Statement& bind(const Args&... args) {
    sqlite3_reset(statement_);
    int index = 0;
    (bind_one(++index, args), ...);
    return *this;
  }
  bool step();  // true: it has reached a row; false: there are no more
  void run();   // executes to the end; then the statement is ready for the next bind()

  int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  double real(int column) const { return sqlite3_column_double(statement_, column); }
  std::span<const uint8_t> blob(int column) const;  // valid until the next step()

 private:
  void bind_one(int index, int64_t value);
  void bind_one(int index, int value) { bind_one(index, static_cast<int64_t>(value)); }
  void bind_one(int index, bool value) { bind_one(index, static_cast<int64_t>(value)); }
  void bind_one(int index, double value);
  void bind_one(int index, const std::optional<double>& value);  // nullopt: NULL
  void bind_one(int index, const std::string& value);
  void bind_one(int index, std::span<const uint8_t> value);
  void check(int code) const;

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

// Rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  void commit();

 private:
  Database& database_;
};

}  // namespace rumi
