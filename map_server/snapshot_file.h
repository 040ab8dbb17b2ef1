// SPDX-License-Identifier: BSD-3-Clause
// Owns map_server.snapshot_file: the copy of the database that is written every map_server.snapshot_s, if anything
// changed, and at the end.
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
  // `save` stores what is not stored yet; it is called before each copy. `period_s` 0: the file is never written.
  SnapshotFile(MapStore& store, std::string file, double period_s, bool in_thread, std::function<void()> save);

  // Takes the copy that is made, and begins one if it is due, none is under way and the store is not behind.
  void tick(int64_t now_us);
  // Writes the file and waits for it.
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
  std::future<Result<>> copy_;  // valid while a copy is made
  WriteTrouble trouble_;
  int64_t last_begin_us_ = 0;
  int64_t copied_changes_ = -1;  // the store's changes() when the last copy was begun
};

}  // namespace rumi::map_server
