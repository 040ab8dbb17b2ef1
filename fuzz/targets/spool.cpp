// SPDX-License-Identifier: BSD-3-Clause
// A file that an earlier ruminator left in the spool. Byte 0 chooses whether the rest is a window or a back submap.
#include <filesystem>

#include "bus/transport/memory_bus.h"
#include "fuzz/good_messages.h"
#include "fuzz/good_window.h"
#include "fuzz/scratch.h"
#include "ruminator/queue/rebuild_queue.h"

namespace rumi::fuzz {
namespace {

using namespace ruminator;

constexpr int kTicks = 4;

BuildResult build(const WindowJob& job, const std::string&, const std::function<void(const BuildProgress&)>&,
                  const std::atomic<bool>&) {
  BuildResult result;
  result.submap = good_submap({job.window.session, -job.window.id}, 2);
  return result;
}

void run(View input) {
  if (input.empty()) return;
  const std::string folder = scratch() / "spool";
  std::filesystem::create_directory(folder);
  scratch().write(input[0] % 2 ? "spool/1000000-1.window" : "spool/1000000-1.submap", input.subspan(1));
  scratch().write("spool/1000000-1.id", {});
  {
    MemoryBus bus;
    RebuildQueueOptions options;
    options.spool = folder;
    options.build_thread = false;
    options.failed_mb = 1;
    RebuildQueue queue(bus, options, build, {});
    for (int i = 1; i <= kTicks; ++i) {
      bus.set_now_us(bus.now_us() + 1'000'000);
      queue.tick(bus.now_us());
      bus.dispatch();
    }
    queue.detail();
    queue.finish();
  }
  std::filesystem::remove_all(folder);
}

std::vector<Bytes> seeds() {
  Bytes window = good_window_file(3), submap = encode_message(make_submap_update(good_submap({kSession, -1}, 2), 0));
  window.insert(window.begin(), 1);
  submap.insert(submap.begin(), 0);
  return {window, submap};
}

const Registered registered({"spool", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
