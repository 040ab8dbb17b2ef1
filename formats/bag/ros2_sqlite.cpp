// SPDX-License-Identifier: BSD-3-Clause
// Reads ROS 2's bags in SQLite: a table of topics and one of messages.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>

#include "base/files/sqlite.h"
#include "formats/bag/bag_file.h"

namespace rumi {
namespace {

constexpr int kMostMessageBytes = 512 << 20;

// Reads the beginning of a message without the rest of its row: later pages of the file are not touched.
class Blob {
 public:
  explicit Blob(Database& database) : database_(database) {}
  ~Blob() { sqlite3_blob_close(blob_); }
  Blob(const Blob&) = delete;
  Blob& operator=(const Blob&) = delete;

  bool go_to(int64_t row) {
    const int code = blob_ ? sqlite3_blob_reopen(blob_, row)
                           : sqlite3_blob_open(database_.handle(), "main", "messages", "data", row, 0, &blob_);
    if (code == SQLITE_OK) return true;
    sqlite3_blob_close(blob_);
    blob_ = nullptr;
    return false;
  }
  int size() const { return sqlite3_blob_bytes(blob_); }
  bool read(uint8_t* out, int count) { return sqlite3_blob_read(blob_, out, count, 0) == SQLITE_OK; }

 private:
  Database& database_;
  sqlite3_blob* blob_ = nullptr;
};

class Ros2Sqlite : public BagFile {
 public:
  explicit Ros2Sqlite(std::string file) : name_(std::move(file)) {
    std::error_code code;
    size_ = static_cast<int64_t>(std::filesystem::file_size(name_, code));
    try {
      database_ = Database::open_to_read(name_);
      // The file comes from another program and may be anything: SQLite must not trust it.
      sqlite3_limit(database_.handle(), SQLITE_LIMIT_LENGTH, kMostMessageBytes);
      sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
      sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
      read_topics();
    } catch (const SqliteError& error) {
      refusal_ = fmt::format("cannot be read as a ROS 2 bag in SQLite: {}", error.what());
    }
  }

  void scan(const Visit& visit) override {
    if (!refusal_.empty()) return;
    Blob blob(database_);
    // If a page is broken, its rows are skipped in growing steps, as rows are numbered consecutively.
    constexpr int64_t kMostSkipped = int64_t{1} << 32;
    int64_t from = std::numeric_limits<int64_t>::min();
    for (int64_t skip = 1; skip < kMostSkipped; skip *= 2) {
      int64_t last = from;
      const std::optional<std::string> why = scan_from(from, visit, &blob, &last);
      if (!why) return;
      count_damage(*why);
      if (last > from) skip = 1;
      from = std::max<int64_t>(0, last) + skip;
    }
  }
  const std::map<uint32_t, BagConnection>& connections() const override { return connections_; }
  const std::map<uint32_t, int64_t>& other_messages() const override { return other_messages_; }
  const BagDamage& damage() const override { return damage_; }
  int64_t size_bytes() const override { return size_; }
  std::string refusal() const override { return refusal_; }
  bool read(const BagPlace& place, std::vector<uint8_t>* bytes) override {
    Blob blob(database_);
    if (!blob.go_to(place.at) || blob.size() > kMostMessageBytes) return false;
    bytes->resize(static_cast<size_t>(blob.size()));
    return blob.read(bytes->data(), blob.size());
  }

 private:
  void read_topics() {
    if (database_.integer(
            "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')") != 2) {
      refusal_ = "is an SQLite file, but no ROS 2 bag: it has no tables topics and messages";
      return;
    }
    Statement select(database_, "SELECT id, name, type, serialization_format FROM topics");
    const auto text = [&select](int column) {
      const auto bytes = select.blob(column);
      return std::string(bytes.begin(), bytes.end());
    };
    while (select.step()) {
      const std::string format = text(3);
      const bool is_cdr = format == "cdr" || format.empty();
      connections_[static_cast<uint32_t>(select.integer(0))] = {text(1),
                                                                is_cdr ? type_named(text(2)) : format + " " + text(2),
                                                                is_cdr ? RosEncoding::kCdr : RosEncoding::kOther};
    }
  }

  // Reads all rows behind `from`; *last becomes the last row that was read. Returns the error that ended it early, or
  // nullopt.
  std::optional<std::string> scan_from(int64_t from, const Visit& visit, Blob* blob, int64_t* last) {
    try {
      Statement select(database_, "SELECT rowid, topic_id, timestamp FROM messages WHERE rowid > ? ORDER BY rowid");
      select.bind(from);
      while (select.step()) {
        *last = select.integer(0);
        BagMessage message;
        message.connection = static_cast<uint32_t>(select.integer(1));
        message.time_ns = select.integer(2);
        if (!take(*last, &message, visit, blob)) break;
      }
      return std::nullopt;
    } catch (const SqliteError& error) {
      return error.what();
    }
  }

  // Returns false if `visit` wants no more.
  bool take(int64_t row, BagMessage* message, const Visit& visit, Blob* blob) {
    const auto known = connections_.find(message->connection);
    if (known != connections_.end() && !known->second.is_read()) {
      ++other_messages_[message->connection];
      return true;
    }
    const bool is_there = blob->go_to(row);
    message->place = {0, BagPlace::kInFile, row, is_there ? blob->size() : 0};
    if (is_there && blob->read(message->head.data(), std::min<int>(kHeadBytes, blob->size()))) return visit(*message);
    count_damage(fmt::format("message {} cannot be read", row));
    return true;
  }

  void count_damage(const std::string& what) {
    if (damage_.places++ == 0) damage_.first = fmt::format("{}: {}", name_, what);
  }

  std::string name_, refusal_;
  int64_t size_ = 0;
  Database database_;
  std::map<uint32_t, BagConnection> connections_;
  std::map<uint32_t, int64_t> other_messages_;
  BagDamage damage_;
};

}  // namespace

std::unique_ptr<BagFile> open_ros2_sqlite(const std::string& file) { return std::make_unique<Ros2Sqlite>(file); }

}  // namespace rumi
