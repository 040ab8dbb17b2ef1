// SPDX-License-Identifier: BSD-3-Clause
// The folder in which windows wait to be rebuilt, and back submaps wait until map_server has stored them. It outlives
// the process.
//
//   S-W.id        window W of session S has been here. The file is empty. The process that holds a lock (flock) on it
//                 works on the window; when that process dies, the lock is gone.
//   S-W.window    the job, which waits or is being rebuilt
//   S-W.tries     a byte for each time that rebuilding has begun
//   S-W.work/     COLMAP's files while the window is rebuilt
//   S-W.submap    the back submap, a submap_update_t that map_server has not acknowledged. The job is over from here
//   on. failed/       jobs that could not be rebuilt (the last 100), each with a .txt that says why and COLMAP's log
//
// Every step is one rename or removal. So whenever a process dies, the files say what remains to be done. Several
// ruminators may share a spool.
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
  // An Error if the folder cannot be created or written to.
  static Result<std::unique_ptr<Spool>> open(const std::string& folder, int64_t max_failed_bytes);

  // The exclusive right to work on a job; given back when it goes out of scope.
  using Claim = FileLock;

  enum class Added { kAdded, kKnown };  // kKnown: a window of this name has been here before
  Result<Added> add(const WindowJob& job);
  // The highest id of this session's windows; 0 if there is none.
  int32_t last_id(int64_t session) const;

  std::vector<JobName> waiting() const;  // to be rebuilt, or being rebuilt, in order
  std::vector<JobName> built() const;    // to be sent to map_server
  // Nothing if another process works on the job, or if the job is no longer here.
  std::optional<Claim> claim(JobName name);

  // The functions below are for the holder of the claim.
  bool is_waiting(JobName name) const;
  bool is_built(JobName name) const;
  // Counts on disk how many times rebuilding has begun, this time included, and returns the count: a job that ends the
  // whole process must not be tried for ever. Removes the work folder of an earlier try. Returns 1 if the disk cannot
  // be written to.
  int begin_try(JobName name);
  void forget_try(JobName name);  // the try was cancelled and does not count
  // Stores the back submap, which ends the job.
  Result<> store_submap(JobName name, std::span<const uint8_t> submap);
  Result<std::vector<uint8_t>> read_submap(JobName name) const;
  // map_server has the back submap: removes everything but the id.
  Result<> complete(JobName name);
  // Moves the job to failed/, then removes the oldest jobs there until the rest fit, and 100 at most. This one stays,
  // even alone, unless nothing is to be kept. Returns its new path; nothing if it is not kept.
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
