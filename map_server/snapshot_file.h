// SPDX-License-Identifier: BSD-3-Clause
// Writes map_server.snapshot_file, a copy of the database: every map_server.snapshot_s if anything changed, and at the
// end.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <string>

#include "map_server/store/map_store.h"
#include "map_server/write_trouble.h"

namespace rumi::map_server {

class SnapshotFile {
 public:
  // `save`: stores what is not stored yet; called before each copy. `period_s` 0: the file is never written.
  SnapshotFile(MapStore& store, std::string file, double period_s, bool in_thread, std::function<void()> save);

  // Takes the result of a finished copy. Begins the next copy if it is due, none is being made, and the store is not
  // behind.
  void tick(int64_t now_us);
  // Writes the file if anything changed since the last copy, and waits until it is written.
  void write_now(int64_t now_us);
  const WriteTrouble& trouble() const { return trouble_; }

 private:
  void begin(int64_t now_us);
  void end();

  MapStore& store_;
  std::string file_;
  int64_t period_us_;
  bool in_thread_;
  std::function<void()> save_;
  std::future<Result<>> copy_;  // valid while a copy is being made
  WriteTrouble trouble_;
  int64_t last_begin_us_ = 0;
  int64_t copied_changes_ = -1;  // the store's changes() when the last copy began
};

}  // namespace rumi::map_server
