// SPDX-License-Identifier: BSD-3-Clause
// Copies of the database while it is in use: SQLite lets readers beside the writer.
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

#include "base/files/scratch_folder.h"
#include "map_server/store/map_store.h"

namespace rumi::map_server {
namespace {

namespace fs = std::filesystem;

constexpr int kStepsBetweenLooks = 1000;  // of SQLite's, at whether a copy is called off

std::string write_copy(Database& database, const std::string& file) {
  const std::string temporary = file + ".tmp";
  std::error_code ignored;
  fs::remove(temporary, ignored);
  try {
    Statement(database, "VACUUM INTO ?").bind(temporary).run();
  } catch (const SqliteError& error) {
    fs::remove(temporary, ignored);
    return fmt::format("cannot write {}: {}", file, error.what());
  }
  std::error_code error;
  fs::rename(temporary, file, error);
  if (!error) return {};
  fs::remove(temporary, ignored);
  return fmt::format("cannot write {}: {}", file, error.message());
}

// Through a connection of its own, for another thread.
std::string write_copy(const std::string& from, const std::string& file, std::atomic<bool>* called_off) {
  try {
    Database database = Database::open_existing(from);
    database.wait_for_others(kReaderWait);
    const auto is_called_off = [](void* flag) { return static_cast<std::atomic<bool>*>(flag)->load() ? 1 : 0; };
    sqlite3_progress_handler(database.handle(), kStepsBetweenLooks, is_called_off, called_off);
    return write_copy(database, file);
  } catch (const SqliteError& error) {
    return fmt::format("cannot read {}: {}", from, error.what());
  }
}

DatabaseBytes read_whole(const std::string& file) {
  DatabaseBytes result;
  std::ifstream in(file, std::ios::binary);
  std::error_code ignored;
  result.bytes.resize(fs::file_size(file, ignored));
  if (in.read(reinterpret_cast<char*>(result.bytes.data()), static_cast<std::streamsize>(result.bytes.size())))
    result.checksum = static_cast<int64_t>(crc32_z(0, result.bytes.data(), result.bytes.size()));
  else
    result = {.bytes = {}, .checksum = 0, .error = fmt::format("cannot read {}", file)};
  return result;
}

}  // namespace

std::string MapStore::write_copy(const std::string& file) { return map_server::write_copy(db_, file); }

std::future<std::string> MapStore::begin_copy(const std::string& file, bool in_thread) {
  if (in_thread && file_ != kInMemory)
    return std::async(std::launch::async, [from = file_, file, called_off = copies_called_off_] {
      return map_server::write_copy(from, file, called_off.get());
    });
  return std::async(std::launch::deferred, [this, file] { return write_copy(file); });
}

std::future<DatabaseBytes> MapStore::begin_copy_bytes(bool in_thread) {
  const bool in_memory = file_ == kInMemory;
  const std::string beside = in_memory ? (fs::path(scratch_folder()) / "map.db").string() : file_;
  const std::string temporary = fmt::format("{}.snapshot-{}", beside, getpid());
  const auto policy = in_thread && !in_memory ? std::launch::async : std::launch::deferred;
  return std::async(policy, [temporary, written = begin_copy(temporary, in_thread)]() mutable {
    std::string error = written.get();
    DatabaseBytes copy =
        error.empty() ? read_whole(temporary) : DatabaseBytes{.bytes = {}, .checksum = 0, .error = std::move(error)};
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return copy;
  });
}

}  // namespace rumi::map_server
