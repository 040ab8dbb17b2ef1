// SPDX-License-Identifier: BSD-3-Clause
// Limits that a shell (`ulimit`), a batch system or a container sets, by their names.
#pragma once

#include <string>

namespace rumi {

// Why a file cannot be written, by errno: "File too large: no file may have more than 0.2 MB here (ulimit -f)" where
// that is the limit, else what the system says.
std::string write_error_text(int error);
// True if there is such a limit.
bool may_be_too_large();

// Says that "there is not enough memory", with the account's limit if it has one.
std::string no_memory_text(const std::string& what = "there is not enough memory");

// As above, for a thread or process that cannot be started.
std::string no_thread_text();

}  // namespace rumi
