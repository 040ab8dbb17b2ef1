// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/stop_signals.h"

#include <unistd.h>

#include <csignal>

namespace rumi::tool {
namespace {

std::atomic<bool> g_stop = false;
std::atomic<int> g_first = 0;
static_assert(std::atomic<int>::is_always_lock_free, "it is used in a signal handler");

void note(int signal) {
  int none = 0;
  g_first.compare_exchange_strong(none, signal);
  g_stop = true;
}

extern "C" void on_stop(int signal) {
  if (g_stop) _exit(128 + signal);
  note(signal);
}

extern "C" void on_hint(int signal) { note(signal); }

}  // namespace

const std::atomic<bool>& listen_to_stop_signals() {
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = on_stop;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  // When a terminal is closed, both the kernel and the shell send SIGHUP, and SIGXCPU comes every second. So a second
  // one of these must not end the process at once. If `nohup` ignores SIGHUP, it stays ignored.
  action.sa_handler = on_hint;
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  sigaction(SIGXCPU, &action, nullptr);
  return g_stop;
}

std::string what_stopped() {
  switch (g_first.load()) {
    case 0:
      return {};
    case SIGINT:
      return "Ctrl-C";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "the end of its terminal";
    default:
      return "the limit of CPU time (ulimit -t)";
  }
}

}  // namespace rumi::tool
