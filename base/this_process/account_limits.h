// SPDX-License-Identifier: BSD-3-Clause
// Texts for errors that come from a limit of a shell (`ulimit`), a batch system or a container: they name the limit.
#pragma once

#include <string>

namespace rumi {

// Returns why a file cannot be written, by errno: "File too large: no file may have more than 0.2 MB here (ulimit -f)"
// if there is such a limit, otherwise the system's text.
std::string write_error_text(int error);
// True if the size of files is limited (ulimit -f).
bool may_be_too_large();

// Returns `what`, with the limit of the account's memory if it has one.
std::string no_memory_text(const std::string& what = "there is not enough memory");

// Returns why a thread or process cannot be started, with the limit of their number if there is one.
std::string no_thread_text();

}  // namespace rumi
