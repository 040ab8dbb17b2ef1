// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// Returns why nothing can be put into the folder ("is not there", "cannot be written to: Read-only file system"), or an
// empty string.
std::string why_unusable(const std::string& folder);

// Chooses a folder for temporary files from TMPDIR, /tmp, /var/tmp, `also` (such as the output folder of a run) and the
// present one: the first that can be written to and has 64 MB free, or else the one with the most free space. If TMPDIR
// is set and not chosen, the log tells why, once. Throws std::runtime_error if none can be used.
std::string scratch_folder(const std::string& also = {});

}  // namespace rumi
