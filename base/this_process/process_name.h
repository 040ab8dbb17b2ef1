// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// Returns the project's version, "0.2.0".
const char* version();
std::string host_name();
// Returns "name@host:pid", unique among all processes: for chunk transfers, and for files that are being written.
std::string unique_process_name(const std::string& process_name);

}  // namespace rumi
