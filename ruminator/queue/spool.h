// SPDX-License-Identifier: BSD-3-Clause
// The folder in which windows wait to be rebuilt, and back submaps wait until map_server has stored them. It outlives
// the process. The files of window W of session S:
//
//   S-W.id        empty; records that the window was added. The process that holds a lock (flock) on this file works
//                 on the window. The lock ends with that process.
//   S-W.window    the job, which waits or is being rebuilt
//   S-W.tries     one byte for each time that rebuilding has begun
//   S-W.work/     COLMAP's files while the window is being rebuilt
//   S-W.submap    the back submap, a submap_update_t that map_server has not acknowledged. The job is no longer needed.
//   failed/       the last 100 jobs that could not be rebuilt, each with the reason (.txt) and COLMAP's log
//
// Each step takes effect by a single change of a file name. So whenever a process dies, the files tell what remains to
// be done. Several ruminators may share a spool.
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/file_lock.h"
#include "base/result.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

struct JobName {
  int64_t session = 0;
  int32_t window_id = 0;
  auto operator<=>(const JobName&) const = default;
};
inline JobName name_of(const RuminationWindow& window) { return {window.session, window.id}; }
std::string to_string(JobName name);  // "S-W"

class Spool {
 public:
  // Returns an Error if the folder cannot be created or written to.
  static Result<std::unique_ptr<Spool>> open(const std::string& folder, int64_t max_failed_bytes);

  // The exclusive right to work on a job, returned when the object is destroyed.
  using Claim = FileLock;

  enum class Added { kAdded, kKnown };  // kKnown: a window of this name has been here before
  Result<Added> add(const WindowJob& job);
  // Returns the highest id of this session's windows, or 0 if it has none.
  int32_t last_id(int64_t session) const;

  std::vector<JobName> waiting() const;  // names of jobs that wait or are being rebuilt, in order
  std::vector<JobName> built() const;    // names of back submaps that map_server has not acknowledged
  // Returns nullopt if another process works on the job.
  std::optional<Claim> claim(JobName name);

  // Only the holder of the claim may call the functions below.
  bool is_waiting(JobName name) const;
  bool is_built(JobName name) const;
  // Counts on disk, and returns, how many times rebuilding this job has begun, this time included, so that a job that
  // makes the process crash is not tried for ever. Removes the work folder of an earlier try. Returns 1 if the disk
  // cannot be written to.
  int begin_try(JobName name);
  void forget_try(JobName name);  // takes back a try that was cancelled
  // Stores the back submap and removes the job.
  Result<> store_submap(JobName name, std::span<const uint8_t> submap);
  Result<std::vector<uint8_t>> read_submap(JobName name) const;
  // Removes all files but the id: map_server has stored the back submap.
  Result<> complete(JobName name);
  // Moves the job to failed/, then removes the oldest jobs there until the others fit and are at most 100. The job
  // itself is kept even if it alone is too large, unless max_failed_bytes is 0. Returns its new path; nullopt if it is
  // not kept.
  std::optional<std::string> fail(JobName name, const std::string& reason);

  std::string window_file(JobName name) const { return file(name, ".window"); }
  std::string work_folder(JobName name) const { return file(name, ".work"); }
  const std::string& folder() const { return folder_; }

 private:
  Spool(std::string folder, int64_t max_failed_bytes);
  std::string file(JobName name, const char* suffix) const;
  std::vector<JobName> list(const char* suffix) const;
  void clean_up();
  void forget_old_ids();
  void prune_failed();

  std::string folder_;
  int64_t max_failed_bytes_;
};

}  // namespace rumi::ruminator
