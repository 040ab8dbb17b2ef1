// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_copies.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "base/files/scratch_folder.h"

namespace rumi::map_server {
namespace {

namespace fs = std::filesystem;

constexpr int kStepsBetweenLooks = 1000;  // SQLite's instructions between two looks at called_off

Result<> copy_to(Database& database, const std::string& file) {
  const std::string temporary = file + ".tmp";
  std::error_code ignored;
  fs::remove(temporary, ignored);
  try {
    Statement(database, "VACUUM INTO ?").bind(temporary).run();
  } catch (const SqliteError& error) {
    fs::remove(temporary, ignored);
    return Error{fmt::format("cannot write {}: {}", file, error.what())};
  }
  std::error_code error;
  fs::rename(temporary, file, error);
  if (!error) return {};
  fs::remove(temporary, ignored);
  return Error{fmt::format("cannot write {}: {}", file, error.message())};
}

// Copies through a connection of its own, because it runs in another thread.
Result<> copy_beside(const std::string& from, const std::string& file, std::atomic<bool>* called_off) {
  try {
    Database database = Database::open_existing(from);
    database.wait_for_others(kReaderWait);
    const auto is_called_off = [](void* flag) { return static_cast<std::atomic<bool>*>(flag)->load() ? 1 : 0; };
    sqlite3_progress_handler(database.handle(), kStepsBetweenLooks, is_called_off, called_off);
    return copy_to(database, file);
  } catch (const SqliteError& error) {
    return Error{fmt::format("cannot read {}: {}", from, error.what())};
  }
}

Result<DatabaseBytes> read_whole(const std::string& file) {
  DatabaseBytes result;
  std::ifstream in(file, std::ios::binary);
  std::error_code ignored;
  result.bytes.resize(fs::file_size(file, ignored));
  if (!in.read(reinterpret_cast<char*>(result.bytes.data()), static_cast<std::streamsize>(result.bytes.size())))
    return Error{fmt::format("cannot read {}", file)};
  result.checksum = static_cast<int64_t>(crc32_z(0, result.bytes.data(), result.bytes.size()));
  return result;
}

}  // namespace

Result<> MapCopies::write(MapDatabase& database, const std::string& file) { return copy_to(database.sqlite(), file); }

std::future<Result<>> MapCopies::begin(MapDatabase& database, const std::string& file, bool in_thread) {
  if (in_thread && !database.is_in_memory())
    return std::async(std::launch::async, [from = database.file(), file, called_off = called_off_] {
      return copy_beside(from, file, called_off.get());
    });
  return std::async(std::launch::deferred, [&database, file] { return write(database, file); });
}

std::future<Result<DatabaseBytes>> MapCopies::begin_bytes(MapDatabase& database, bool in_thread) {
  const bool in_memory = database.is_in_memory();
  const std::string beside = in_memory ? (fs::path(scratch_folder()) / "map.db").string() : database.file();
  const std::string temporary = fmt::format("{}.snapshot-{}", beside, getpid());
  const auto policy = in_thread && !in_memory ? std::launch::async : std::launch::deferred;
  return std::async(policy, [temporary, copied = begin(database, temporary, in_thread)]() mutable {
    const Result<> written = copied.get();
    Result<DatabaseBytes> bytes = written ? read_whole(temporary) : Result<DatabaseBytes>(written.error());
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return bytes;
  });
}

}  // namespace rumi::map_server
