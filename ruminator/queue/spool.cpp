// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/spool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <utility>

#include "base/files/file_access.h"
#include "base/files/whole_file.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/transport/bus.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kId = ".id";
constexpr const char* kWindow = ".window";
constexpr const char* kTries = ".tries";
constexpr const char* kWork = ".work";
constexpr const char* kSubmap = ".submap";
constexpr const char* kFailedFolder = "failed";
constexpr size_t kMaxFailed = 100;              // most failed windows that are kept: nobody would look at more
constexpr size_t kMaxIds = 1000;                // most empty files that only record used names
constexpr std::chrono::hours kAbandonedAge{1};  // if a temporary file is this old, its writer must have died

std::optional<JobName> parse(const std::string& stem) {
  JobName name;
  const char* end = stem.data() + stem.size();
  const auto [dash, bad_session] = std::from_chars(stem.data(), end, name.session);
  if (bad_session != std::errc() || dash == end || *dash != '-') return std::nullopt;
  const auto [rest, bad_id] = std::from_chars(dash + 1, end, name.window_id);
  const bool ours = bad_id == std::errc() && rest == end && to_string(name) == stem && name.window_id > 0;
  return ours ? std::optional(name) : std::nullopt;
}

// Returns the paths in a folder, sorted. If the folder cannot be read, returns what was read until then.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    paths.push_back(it->path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

void remove_quietly(const fs::path& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

bool exists(const std::string& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

// Appends the logs in the work folder of a build to one file.
void gather_logs(const fs::path& work, const std::string& log_file) {
  std::vector<fs::path> logs;
  for (const fs::path& path : entries(work))
    if (path.extension() == ".log") logs.push_back(path);
  if (logs.empty()) return;
  std::ofstream out(log_file, std::ios::binary | std::ios::app);
  for (const fs::path& log : logs) {
    out << "==> " << log.filename().string() << "\n";
    if (std::ifstream in(log, std::ios::binary); in.peek() != std::ifstream::traits_type::eof()) out << in.rdbuf();
  }
}

}  // namespace

std::string to_string(JobName name) { return fmt::format("{}-{}", name.session, name.window_id); }

Spool::Spool(std::string folder, int64_t max_failed_bytes)
    : folder_(std::move(folder)), max_failed_bytes_(max_failed_bytes) {}

namespace {

Error unusable(const std::string& folder, const std::string& reason) {
  return {fmt::format("windows cannot be kept in it ({}{})", reason, note_on_owner(folder)), folder,
          "name another folder with --set ruminator.spool=FOLDER"};
}

}  // namespace

Result<std::unique_ptr<Spool>> Spool::open(const std::string& folder, int64_t max_failed_bytes) {
  std::error_code code;
  fs::create_directories(fs::path(folder) / kFailedFolder, code);
  if (code) return unusable(folder, code.message());
  const std::string probe = temporary_name((fs::path(folder) / "probe").string());
  const int fd = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return unusable(folder, std::strerror(errno));
  close(fd);
  unlink(probe.c_str());
  std::unique_ptr<Spool> spool(new Spool(folder, max_failed_bytes));
  spool->clean_up();
  return spool;
}

std::string Spool::file(JobName name, const char* suffix) const {
  return (fs::path(folder_) / (to_string(name) + suffix)).string();
}

std::vector<JobName> Spool::list(const char* suffix) const {
  std::vector<JobName> names;
  for (const fs::path& path : entries(folder_))
    if (path.extension() == suffix)
      if (const std::optional<JobName> name = parse(path.stem().string())) names.push_back(*name);
  std::sort(names.begin(), names.end());
  return names;
}

// Removes files of dead processes that nobody will need.
void Spool::clean_up() {
  for (const fs::path& path : entries(folder_)) {
    std::error_code error;
    const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, error);
    if (!error && path.extension() == ".tmp" && age > kAbandonedAge) remove_quietly(path);
  }
  for (const char* suffix : {kWork, kTries})
    for (const JobName name : list(suffix))
      if (!is_waiting(name))
        if (const auto mine = claim(name); mine && !is_waiting(name)) remove_quietly(file(name, suffix));
  forget_old_ids();
  prune_failed();
}

void Spool::forget_old_ids() {
  std::vector<JobName> ids = list(kId);
  std::erase_if(ids, [this](JobName name) { return is_waiting(name) || is_built(name); });
  for (size_t i = 0; i + kMaxIds < ids.size(); ++i) unlink(file(ids[i], kId).c_str());
}

Result<Spool::Added> Spool::add(const WindowJob& job) {
  const StageClock clock("ruminator.store");
  const JobName name = name_of(job.window);
  const std::string id = file(name, kId);
  const int fd = ::open(id.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0 && errno == EEXIST) return Added::kKnown;
  if (fd < 0) return Error{fmt::format("cannot be written ({})", std::strerror(errno)), id};
  close(fd);
  if (const Result<> written = write_window_job(window_file(name), job); !written) return written.error();
  return Added::kAdded;
}

int32_t Spool::last_id(int64_t session) const {
  int32_t last = 0;
  for (const char* suffix : {kId, kWindow, kSubmap})
    for (const JobName name : list(suffix))
      if (name.session == session) last = std::max(last, name.window_id);
  return last;
}

std::vector<JobName> Spool::waiting() const {
  std::vector<JobName> names = list(kWindow);
  std::erase_if(names, [this](JobName name) { return is_built(name); });
  return names;
}

std::vector<JobName> Spool::built() const { return list(kSubmap); }
bool Spool::is_built(JobName name) const { return exists(file(name, kSubmap)); }
bool Spool::is_waiting(JobName name) const { return exists(window_file(name)) && !is_built(name); }

std::optional<Spool::Claim> Spool::claim(JobName name) {
  // The id file is missing if a user put a job here by hand; take() then creates it.
  std::optional<Claim> claim = Claim::take(file(name, kId));
  if (!claim) return std::nullopt;
  // The previous owner may have died after it stored the submap, but before it removed the job.
  if (is_built(name)) remove_quietly(window_file(name));
  return claim;
}

int Spool::begin_try(JobName name) {
  remove_quietly(work_folder(name));
  const int fd = ::open(file(name, kTries).c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (fd < 0) return 1;
  struct stat info {};
  const bool counted = write(fd, "|", 1) == 1 && fsync(fd) == 0 && fstat(fd, &info) == 0;
  close(fd);
  return counted ? static_cast<int>(std::min<off_t>(info.st_size, INT32_MAX)) : 1;
}

void Spool::forget_try(JobName name) {
  const std::string tries = file(name, kTries);
  std::error_code error;
  const auto size = fs::file_size(tries, error);
  if (!error && size > 0) fs::resize_file(tries, size - 1, error);
  remove_quietly(work_folder(name));
}

Result<> Spool::store_submap(JobName name, std::span<const uint8_t> submap) {
  const StageClock clock("ruminator.store");
  WholeFile stored(file(name, kSubmap));
  stored.write({reinterpret_cast<const char*>(submap.data()), submap.size()});
  if (Result<> written = stored.commit(); !written) return written;
  for (const char* suffix : {kWindow, kTries, kWork}) remove_quietly(file(name, suffix));
  return {};
}

Result<std::vector<uint8_t>> Spool::read_submap(JobName name) const {
  const std::string path = file(name, kSubmap);
  std::error_code code;
  const auto bytes = fs::file_size(path, code);
  if (code) return Error{fmt::format("cannot be read ({})", code.message()), path};
  if (bytes > kMaxMessageBytes)
    return Error{fmt::format("has {} bytes, a back submap has at most {}", bytes, kMaxMessageBytes), path};
  std::vector<uint8_t> submap(bytes);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(submap.data()), static_cast<std::streamsize>(bytes)))
    return Error{fmt::format("cannot be read ({})", std::strerror(errno)), path};
  return submap;
}

Result<> Spool::complete(JobName name) {
  for (const char* suffix : {kWindow, kTries, kWork}) remove_quietly(file(name, suffix));
  const std::string submap = file(name, kSubmap);
  if (unlink(submap.c_str()) == 0 || errno == ENOENT) return {};
  return Error{fmt::format("cannot be removed ({})", std::strerror(errno)), submap};
}

std::optional<std::string> Spool::fail(JobName name, const std::string& reason) {
  const fs::path failed = fs::path(folder_) / kFailedFolder / to_string(name);
  std::ofstream(failed.string() + ".txt") << reason << "\n";
  gather_logs(work_folder(name), failed.string() + ".log");
  std::optional<std::string> kept;
  for (const char* suffix : {kWindow, kSubmap}) {
    const std::string target = failed.string() + suffix;
    if (std::rename(file(name, suffix).c_str(), target.c_str()) == 0) kept = target;
  }
  if (!kept && is_waiting(name))
    log_error("{}: cannot be moved to {} ({})", window_file(name), failed.string(), std::strerror(errno));
  for (const char* suffix : {kTries, kWork}) remove_quietly(file(name, suffix));
  prune_failed();
  return kept && exists(*kept) ? kept : std::nullopt;
}

void Spool::prune_failed() {
  struct Failure {
    fs::file_time_type time = fs::file_time_type::min();  // modification time of its newest file
    int64_t bytes = 0;
    std::vector<fs::path> files;
  };
  std::map<std::string, Failure> failures;
  int64_t total = 0;
  for (const fs::path& path : entries(fs::path(folder_) / kFailedFolder)) {
    std::error_code error;
    const auto bytes = static_cast<int64_t>(fs::file_size(path, error));
    const auto time = error ? fs::file_time_type::min() : fs::last_write_time(path, error);
    if (error) continue;
    Failure& failure = failures[path.stem().string()];
    failure.time = std::max(failure.time, time);
    failure.bytes += bytes;
    failure.files.push_back(path);
    total += bytes;
  }
  // The latest failure is kept even if it is too large by itself: its file may have been put here by a user.
  const size_t left = max_failed_bytes_ > 0 ? 1 : 0;
  while (failures.size() > left && (total > max_failed_bytes_ || failures.size() > kMaxFailed)) {
    const auto oldest = std::min_element(failures.begin(), failures.end(),
                                         [](const auto& a, const auto& b) { return a.second.time < b.second.time; });
    for (const fs::path& path : oldest->second.files) remove_quietly(path);
    total -= oldest->second.bytes;
    failures.erase(oldest);
  }
}

}  // namespace rumi::ruminator
