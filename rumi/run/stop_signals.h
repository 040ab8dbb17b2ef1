// SPDX-License-Identifier: BSD-3-Clause
// Lets long work end early when the user asks for it, and keep what is done.
#pragma once

#include <atomic>
#include <string>

namespace rumi::tool {

// From now on Ctrl-C, SIGTERM, a closed terminal (SIGHUP) and the soft limit of CPU time (SIGXCPU) set the returned
// flag. A second Ctrl-C or SIGTERM ends the process at once.
const std::atomic<bool>& listen_to_stop_signals();

// Returns the signal that asked for the end: "Ctrl-C", "SIGTERM", ...; empty if none did.
std::string what_stopped();

}  // namespace rumi::tool
