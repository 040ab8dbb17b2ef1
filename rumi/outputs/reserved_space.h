// SPDX-License-Identifier: BSD-3-Clause
// Room on the disk for the outputs that a run writes at its end. It is taken at the beginning, so that an hour of work
// is not lost because something else filled the disk meanwhile.
#pragma once

#include <cstdint>
#include <string>

#include "base/files/file_descriptor.h"
#include "base/result.h"

namespace rumi::tool {

class ReservedSpace {
 public:
  // Reserves space for the paths and tables of a run of so many images (-1: unknown); the map is larger. An Error if
  // the disk has not even that much. A file system that cannot reserve space is accepted.
  Result<> take(const std::string& folder, int64_t images);
  // Call it before the outputs are written.
  void release() { file_.reset(); }

 private:
  FileDescriptor file_;  // without a name, so that it vanishes however the process ends
};

// A warning if the disk may be too small, else an empty string. The size of a map is not known before it is there; it
// is estimated by that of usual maps.
std::string doubt_about_space(const std::string& folder, int64_t images);

}  // namespace rumi::tool
