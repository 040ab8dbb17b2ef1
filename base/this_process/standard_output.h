// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether printed text is written: on a full disk, printing succeeds and only flushing fails.
#pragma once

#include <string>

namespace rumi {

// Occupies the closed ones of stdin, stdout and stderr, so that writing to them fails. Otherwise the next file that is
// opened takes the place of a closed one, and printed text goes into that file. To be called before any file is opened.
void hold_standard_streams();

// Flushes everything that was printed. Returns an empty string if all of it has been written since the program began,
// or an error such as "cannot write: No space left on device".
std::string flush_stdout();

}  // namespace rumi
