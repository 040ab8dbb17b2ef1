// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether printed text arrives: a full disk accepts it silently until it is flushed.
#pragma once

#include <string>

namespace rumi {

// If stdin, stdout or stderr is closed, the next file that is opened would take its place, and printed text would go
// into that file. To be called before any file is opened: it occupies the closed streams, and writing to them fails.
void hold_standard_streams();

// Flushes everything that was printed. Returns "cannot write: No space left on device" if not all of it could be
// written since the program began, or an empty string.
std::string flush_stdout();

}  // namespace rumi
