// SPDX-License-Identifier: BSD-3-Clause
// Disk space for the outputs that a run writes at its end. It is reserved at the beginning, so that an hour of work is
// not lost because something else has filled the disk meanwhile.
#pragma once

#include <cstdint>
#include <string>

#include "base/files/file_descriptor.h"
#include "base/result.h"

namespace rumi::tool {

class ReservedSpace {
 public:
  // Reserves space for the paths and tables of a run of `images` images (-1: unknown), not for the map. An Error if the
  // disk has not even that much. A file system that cannot reserve space is accepted.
  Result<> take(const std::string& folder, int64_t images);
  // Frees the space. Call it before the outputs are written.
  void release() { file_.reset(); }

 private:
  FileDescriptor file_;  // has no name, so it vanishes however the process ends
};

// Returns a warning if the disk may be too small, else an empty string. The size of the map is not known in advance;
// that of usual maps is assumed.
std::string doubt_about_space(const std::string& folder, int64_t images);

}  // namespace rumi::tool
