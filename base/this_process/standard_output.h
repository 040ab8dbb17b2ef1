// SPDX-License-Identifier: BSD-3-Clause
// Whether what a program prints arrives: a full disk takes it without a word until it is flushed.
#pragma once

#include <string>

namespace rumi {

// Where stdin, stdout or stderr are closed, the next file that is opened would take its place, and what is printed
// would go into that file. Called before any file is opened: each then stands for nothing, and writing to it is an
// error.
void hold_standard_streams();

// Everything that was printed is on its way. Returns "cannot write: No space left on device" if not all of it could be
// written since the program began, or an empty string.
std::string flush_stdout();

}  // namespace rumi
