// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/snapshot_file.h"

#include <utility>

#include "base/running/due.h"
#include "base/running/is_ready.h"
#include "base/running/stage_clock.h"

namespace rumi::map_server {

SnapshotFile::SnapshotFile(MapStore& store, std::string file, double period_s, bool in_thread,
                           std::function<void()> save)
    : store_(store),
      file_(std::move(file)),
      period_us_(static_cast<int64_t>(period_s * 1e6)),
      in_thread_(in_thread),
      save_(std::move(save)),
      trouble_(file_) {}

void SnapshotFile::tick(int64_t now_us) {
  if (last_begin_us_ == 0) last_begin_us_ = now_us;
  if (is_ready(copy_)) end();
  const bool may_begin = !copy_.valid() && !store_.is_behind();
  if (period_us_ <= 0 || !may_begin || !is_due(now_us, last_begin_us_, period_us_)) return;
  begin(now_us);
  if (is_ready(copy_)) end();
}

void SnapshotFile::write_now(int64_t now_us) {
  if (period_us_ <= 0) return;
  end();
  begin(now_us);
  end();
}

void SnapshotFile::begin(int64_t now_us) {
  const StageClock clock("map_server.store");
  last_begin_us_ = now_us;
  save_();
  const int64_t changes = store_.changes();
  if (changes == copied_changes_) return;
  copied_changes_ = changes;
  copy_ = store_.begin_copy(file_, in_thread_);
}

// Waits for the copy, if one is being made.
void SnapshotFile::end() {
  if (!copy_.valid()) return;
  const StageClock clock("map_server.store");
  const Result<> written = copy_.get();
  if (!written) copied_changes_ = -1;
  trouble_.note(written);
}

}  // namespace rumi::map_server
