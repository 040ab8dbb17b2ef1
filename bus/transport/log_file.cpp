// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/log_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/this_process/account_limits.h"

namespace rumi {
namespace {

// Layout of an event, big endian: int32 sync, int64 number, int64 time, int32 channel length, int32 data length,
// channel, data. Events are read here and not by LCM, which cannot tell the end of a file from damage and believes any
// length.
constexpr uint32_t kSync = 0xEDA1DA01;
constexpr size_t kHeaderBytes = 28;
constexpr uint32_t kMaxChannelLength = 1000;  // LCM's own limit for channel names in logs

uint64_t big_endian(const uint8_t* bytes, int count) {
  uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

// True if the lengths in the header are possible. *end is then the position of the event's end.
bool has_sensible_lengths(const std::array<uint8_t, kHeaderBytes>& header, int64_t position, int64_t* end) {
  const auto channel_length = static_cast<uint32_t>(big_endian(&header[20], 4));
  const auto data_length = static_cast<uint32_t>(big_endian(&header[24], 4));
  *end = position + static_cast<int64_t>(kHeaderBytes) + channel_length + data_length;
  return channel_length > 0 && channel_length <= kMaxChannelLength && data_length <= INT32_MAX;
}

}  // namespace

bool is_lcm_log(const std::string& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> f(std::fopen(file.c_str(), "rb"), &std::fclose);
  std::array<uint8_t, 4> start{};
  return f && std::fread(start.data(), 1, start.size(), f.get()) == start.size() &&
         big_endian(start.data(), 4) == kSync;
}

LogReader::LogReader(const std::string& file) : name_(file), file_(std::fopen(file.c_str(), "rb")) {
  struct stat info {};
  if (!file_)
    error_ = fmt::format("{}: cannot be opened ({})", file, std::strerror(errno));
  else if (fstat(fileno(file_.get()), &info) != 0 || !S_ISREG(info.st_mode))
    error_ = file + ": is not a file";
  size_ = info.st_size;
}

std::optional<LogEvent> LogReader::next() { return read(nullptr, SIZE_MAX); }
std::optional<LogEvent> LogReader::next_head(size_t most_bytes) { return read(nullptr, most_bytes); }
std::optional<LogEvent> LogReader::next_on(const std::string& channel, size_t most_bytes) {
  return read(&channel, most_bytes);
}

void LogReader::seek(int64_t position) {
  if (!file_ || fseeko(file_.get(), position, SEEK_SET) != 0) return;
  position_ = position;
  error_.clear();
}

std::nullopt_t LogReader::fail(const std::string& reason) {
  error_ =
      fmt::format("{}: damaged at byte {}, {}; the {} events before it are good", name_, position_, reason, events_);
  return std::nullopt;
}

std::optional<LogEvent> LogReader::read(const std::string* only_channel, size_t most_bytes) {
  while (error_.empty() && position_ < size_) {
    std::array<uint8_t, kHeaderBytes> header{};
    if (std::fread(header.data(), 1, header.size(), file_.get()) != header.size())
      return fail("it ends in the middle of an event");
    if (big_endian(header.data(), 4) != kSync)
      return fail(events_ == 0 ? "this is not an lcm log" : "no event begins here");
    const auto channel_length = static_cast<uint32_t>(big_endian(&header[20], 4));
    const auto data_length = static_cast<uint32_t>(big_endian(&header[24], 4));
    int64_t end = 0;
    if (!has_sensible_lengths(header, position_, &end)) return fail("a length makes no sense");
    if (end > size_) return fail("it ends in the middle of an event");

    LogEvent event{static_cast<int64_t>(big_endian(&header[12], 8)), std::string(channel_length, '\0'), {}};
    if (std::fread(event.channel.data(), 1, channel_length, file_.get()) != channel_length)
      return fail("it cannot be read");
    const bool wanted = !only_channel || event.channel == *only_channel;
    if (wanted) event.data.resize(std::min<size_t>(data_length, most_bytes));
    const bool is_read = std::fread(event.data.data(), 1, event.data.size(), file_.get()) == event.data.size();
    const bool is_passed = event.data.size() == data_length || fseeko(file_.get(), end, SEEK_SET) == 0;
    if (!is_read || !is_passed) return fail("it cannot be read");
    last_ = position_;
    last_data_ = end - data_length;
    position_ = last_end_ = end;
    ++events_;
    if (wanted) return event;
  }
  return std::nullopt;
}

bool LogReader::read_at(int64_t position, std::span<uint8_t> bytes) {
  return fseeko(file_.get(), position, SEEK_SET) == 0 &&
         std::fread(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size();
}

std::vector<uint8_t> LogReader::data_of_last(size_t from) {
  const int64_t begin = last_data_ + static_cast<int64_t>(from);
  std::vector<uint8_t> data(static_cast<size_t>(std::max<int64_t>(0, last_end_ - begin)));
  if (!file_ || !read_at(begin, data)) data.clear();
  if (file_) fseeko(file_.get(), position_, SEEK_SET);
  return data;
}

bool LogReader::may_begin_at(int64_t position) {
  std::array<uint8_t, kHeaderBytes> header{};
  int64_t end = 0;
  if (!read_at(position, header) || !has_sensible_lengths(header, position, &end) || end > size_) return false;
  std::string channel(big_endian(&header[20], 4), '\0');
  return std::fread(channel.data(), 1, channel.size(), file_.get()) == channel.size() &&
         std::none_of(channel.begin(), channel.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

// Searches from within the last event on: if the length of that event is damaged, it hides events behind it.
bool LogReader::go_on() {
  if (!file_) return false;
  constexpr std::array<uint8_t, 4> kMark = {kSync >> 24, kSync >> 16 & 0xFF, kSync >> 8 & 0xFF, kSync & 0xFF};
  constexpr int64_t kPartBytes = 1 << 16, kOverlap = kMark.size() - 1;
  std::vector<uint8_t> part;
  for (int64_t begin = std::max(events_ > 0 ? last_ : position_, resumed_) + 1; begin < size_;
       begin += kPartBytes - kOverlap) {
    part.resize(static_cast<size_t>(std::min(kPartBytes, size_ - begin)));
    if (!read_at(begin, part)) return false;
    for (auto from = part.begin();; ++from) {
      from = std::search(from, part.end(), kMark.begin(), kMark.end());
      if (from == part.end()) break;
      const int64_t at = begin + (from - part.begin());
      if (!may_begin_at(at)) continue;
      seek(at);
      resumed_ = at;
      return true;
    }
  }
  return false;
}

LogWriter::LogWriter(const std::string& file) : name_(file), log_(std::make_unique<lcm::LogFile>(file, "w")) {
  if (log_->good()) return;
  error_ = fmt::format("{}: cannot be created ({})", file, std::strerror(errno));
  log_.reset();
}

LogWriter::~LogWriter() { close(); }

bool LogWriter::write(int64_t utime_us, const std::string& channel, std::span<const uint8_t> data) {
  if (!log_ || !error_.empty()) return false;
  lcm::LogEvent event{};
  event.timestamp = utime_us;
  event.channel = channel;
  event.datalen = static_cast<int32_t>(data.size());
  event.data = const_cast<uint8_t*>(data.data());  // LCM only reads it
  errno = 0;
  if (log_->writeEvent(&event) == 0) return true;
  error_ = fmt::format("{}: cannot be written ({})", name_, write_error_text(errno));
  return false;
}

bool LogWriter::close() {
  if (log_ && std::fflush(log_->getFilePtr()) != 0 && error_.empty())
    error_ = fmt::format("{}: cannot be written ({})", name_, write_error_text(errno));
  log_.reset();
  return error_.empty();
}

}  // namespace rumi
