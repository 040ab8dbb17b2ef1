// SPDX-License-Identifier: BSD-3-Clause
// A window file. A good one is written again.
#include "fuzz/good_messages.h"
#include "fuzz/good_window.h"
#include "fuzz/log_bytes.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

using namespace ruminator;

void run(View input) {
  const std::string file = scratch().write("some.window", input);
  const Result<WindowJob> manifest = read_window_manifest(file);
  const Result<WindowJobFile> window = read_window_job(file);
  if (window && !manifest) throw std::logic_error("a window that could be read has no manifest that can be read");
  if (window && !write_window_job(scratch() / "again.window", window->job) && window->broken_images == 0)
    throw std::logic_error("a window that could be read cannot be written");
}

std::vector<Bytes> seeds() { return {good_window_file(4)}; }

const Registered registered({"window_file", run, seeds, mutate_log<0>});

}  // namespace
}  // namespace rumi::fuzz
