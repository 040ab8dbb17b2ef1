// SPDX-License-Identifier: BSD-3-Clause
// Updates of one submap, applied one after another as every process applies them. They are the payloads of a script.
#include "bus/wire/submap_update.h"

#include "fuzz/good_messages.h"
#include "lcmtypes/rumi/chunk_t.hpp"
#include "map_server/atlas/placement.h"

namespace rumi::fuzz {
namespace {

void run(View input) {
  Submap submap;
  for (const Event& event : parse_script(input)) {
    submap_update_t update;
    if (event.bytes.size() < 2 || !Bus::decode(View(event.bytes).subspan(2), &update)) continue;
    if (!apply_submap_update(update, &submap) || submap.revision == 0) continue;
    for (const auto& [utime_us, frame] : submap.frames) submap.cam_from_submap(frame);
    Submap copy;
    const std::string wrong = apply_submap_update(make_submap_update(submap, 0), &copy).error_text();
    if (!wrong.empty()) throw std::logic_error("what was taken is not taken again: " + wrong);
    map_server::place(submap, {});
  }
}

std::vector<Bytes> seeds() {
  const SubmapKey front{kSession, 1}, back{kSession, -1};
  const auto update = [](SubmapKey key, int keyframes, int64_t base) {
    return payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap(key, keyframes), base));
  };
  submap_update_t removes = make_submap_update(good_submap(front, 3), 3);
  removes.revision = 4;
  removes.removed_keyframes = {1};
  removes.nremoved_keyframes = 1;
  return {to_bytes(Script{update(front, 2, 0), update(front, 3, 2), payload(0, removes)}),
          to_bytes(Script{update(back, 2, 0)})};
}

const Registered registered({"submap_update", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
