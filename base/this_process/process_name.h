// SPDX-License-Identifier: BSD-3-Clause
// How this process is called.
#pragma once

#include <string>

namespace rumi {

// The project's version, "0.2.0".
const char* version();
std::string host_name();
// "name@host:pid", unique among all processes: sender and receiver in chunk transfers, files that are being written.
std::string unique_process_name(const std::string& process_name);

}  // namespace rumi
