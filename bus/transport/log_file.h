// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes files in the format of lcm-logger, event by event.
#pragma once

#include <cstdint>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rumi {

struct LogEvent {
  int64_t utime_us = 0;
  std::string channel;
  std::vector<uint8_t> data;
};

// True if the file begins like an lcm log; false also if it cannot be read.
bool is_lcm_log(const std::string& file);

class LogReader {
 public:
  explicit LogReader(const std::string& file);  // see error()

  // Reads the next event; nullopt at the end of the file and at damage, which error() then describes. All events before
  // the damage are delivered.
  std::optional<LogEvent> next();
  // Reads the next event of one channel; nullopt as in next(). Data of other channels is skipped unread, and so is data
  // beyond `most_bytes`.
  std::optional<LogEvent> next_on(const std::string& channel, size_t most_bytes = SIZE_MAX);
  // Reads the next event of any channel, with at most the first `most_bytes` of its data; nullopt as in next().
  std::optional<LogEvent> next_head(size_t most_bytes);
  // Returns the position of the last event that was read. After seek() to it, the same event is read again.
  int64_t position_of_last() const { return last_; }
  void seek(int64_t position);
  // Moves behind damage, to the next place where an event may begin. Returns false if there is no such place; error()
  // then stays.
  bool go_on();
  // Returns the data of the last event from byte `from` on, also those that were skipped; empty if they cannot be read.
  // Does not change what is read next.
  std::vector<uint8_t> data_of_last(size_t from);
  int64_t position() const { return position_; }  // position of the next event, or of the damage
  // Says why the file could not be opened or read on, with its name and the place; empty if it could.
  const std::string& error() const { return error_; }
  int64_t size_bytes() const { return size_; }  // size of the file

 private:
  std::optional<LogEvent> read(const std::string* only_channel, size_t most_bytes);
  std::nullopt_t fail(const std::string& reason);
  bool may_begin_at(int64_t position);
  bool read_at(int64_t position, std::span<uint8_t> bytes);
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string name_, error_;
  std::unique_ptr<std::FILE, Close> file_;
  int64_t size_ = 0;      // bytes in the file
  int64_t position_ = 0;  // position of the next event
  int64_t last_ = 0;      // position of the last event
  int64_t last_data_ = 0, last_end_ = 0;
  int64_t resumed_ = -1;  // position at which reading went on behind damage
  int64_t events_ = 0;    // events read so far
};

class LogWriter {
 public:
  explicit LogWriter(const std::string& file);  // replaces a file of that name; see error()
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  // Returns false from the first failure on (disk full). What was written before is a readable log.
  bool write(int64_t utime_us, const std::string& channel, std::span<const uint8_t> data);
  // Returns true if everything has reached the file.
  bool close();
  const std::string& error() const { return error_; }

 private:
  std::string name_, error_;
  std::unique_ptr<lcm::LogFile> log_;
};

}  // namespace rumi
