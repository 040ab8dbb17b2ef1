// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// Why nothing can be put into the folder ("is not there", "cannot be written to: Read-only file system"), or an empty
// string.
std::string why_unusable(const std::string& folder);

// A folder for temporary files: TMPDIR, /tmp, /var/tmp, `also` (such as that of a run's outputs) or the present one,
// whichever is there, can be written to and has room. Where TMPDIR is set and is not it, the log tells why, once.
// Throws std::runtime_error where none will do.
std::string scratch_folder(const std::string& also = {});

}  // namespace rumi
