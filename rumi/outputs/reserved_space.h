// SPDX-License-Identifier: BSD-3-Clause
// Room on the disk for what a run writes at its end, kept from its beginning on, so that an hour of work is not lost
// because something else filled the disk meanwhile.
#pragma once

#include <cstdint>
#include <string>

#include "base/files/file_descriptor.h"

namespace rumi::tool {

class ReservedSpace {
 public:
  // For a run of so many images (-1: nobody knows): its paths and tables; the map is larger. Returns why there is not
  // even that, or an empty string. A file system that cannot reserve anything is taken as it is.
  std::string take(const std::string& folder, int64_t images);
  // The outputs are written now.
  void release() { file_.reset(); }

 private:
  FileDescriptor file_;  // has no name: nothing is left of it, however the process ends
};

// What may not fit: a line for a person, or an empty string. Of the size of a map nothing is known before it is there,
// so this is what many are like.
std::string doubt_about_space(const std::string& folder, int64_t images);

}  // namespace rumi::tool
