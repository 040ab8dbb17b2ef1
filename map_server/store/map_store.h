// SPDX-License-Identifier: BSD-3-Clause
// The atlas on disk: one SQLite file. What save() has accepted is there after a kill -9 at any moment, and after a loss
// of power too (WAL, synchronous=FULL). The schema is in map_store_schema.h.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/database_lock.h"

namespace rumi::map_server {

inline constexpr std::chrono::milliseconds kSaveBudget{15};  // of map_server's tick: nobody is heard meanwhile

inline constexpr const char* kInMemory = ":memory:";

// So long a reader waits for another program that has a database locked.
inline constexpr std::chrono::seconds kReaderWait{10};

// A whole database, to be sent.
struct DatabaseBytes {
  std::vector<uint8_t> bytes;
  int64_t checksum = 0;  // CRC-32
  std::string error;     // empty, or why there are none
};

class MapStore {
 public:
  // Opens or creates FILE and takes FILE.lock; ":memory:" keeps everything in memory. A file of an older schema version
  // is brought to ours in one transaction. Throws std::runtime_error with a
  // message for the user if the file is locked, damaged, no map, of a newer version or not writable.
  explicit MapStore(const std::string& file);
  // In memory, what the file holds now: whatever becomes of it, the file stays as it is. Another process may have it
  // open. Throws std::runtime_error if it is not there, is still locked after `wait`, or as above.
  static MapStore copy_in_memory(const std::string& file, std::chrono::milliseconds wait = kReaderWait);

  // The atlas as it was when last saved, bit for bit. Throws std::runtime_error if the content contradicts itself.
  Atlas load();

  // Writes what changed in the atlas since it was last saved or loaded, and the records of the frames named, in one
  // transaction: all of it or, with a reason, nothing. After a failure the next save() catches up. Submaps and
  // where they lie may take long to write: when the time of a `budget` is over, the rest is left to the next save(),
  // and until all is written the file has the map as it was before, with its links.
  std::string save(const Atlas& atlas, const std::vector<ImageId>& frames,
                   std::optional<std::chrono::milliseconds> budget = {});
  // Something is left to the next save().
  bool is_behind() const { return is_behind_; }

  // Revision of the submap in the file, 0 if it is not there.
  int64_t stored_revision(SubmapKey key) const;

  // A consistent, compact copy of all that is saved. An existing file is replaced in one step. Returns what went wrong.
  std::string write_copy(const std::string& file);
  // The same beside whoever asks, who may go on saving: at once in a thread, or, without threads or a file, when the
  // result is asked for.
  std::future<std::string> begin_copy(const std::string& file, bool in_thread);
  std::future<DatabaseBytes> begin_copy_bytes(bool in_thread);
  // Those in threads fail soon, also such as are begun later: the process ends.
  void call_off_copies() { *copies_called_off_ = true; }

  int64_t bytes();          // of the database; if that cannot be read now, what it was
  int64_t changes() const;  // rows written since it was opened: whether there is anything new to copy
  const std::string& file() const { return file_; }
  // No more than this many bytes (rounded to pages): a save() beyond it fails like one on a full disk.
  void limit_bytes(int64_t bytes);

 private:
  MapStore() = default;
  struct Stored {
    int64_t row = 0;  // submaps.submap
    int64_t revision = 0;
    bool in_map = false;
    int64_t placement_revision = 0;          // that counts
    int64_t written_placement_revision = 0;  // that is to count when all others are written, too
    bool has_others = true;                  // there may be rows of neither
  };
  using Rows = std::map<SubmapKey, Stored>;
  using Deadline = std::chrono::steady_clock::time_point;
  void open();  // db_: checks what is there, or makes it
  void bring_up(int64_t version);
  bool save_submaps(const Atlas& atlas, Deadline deadline, Rows* rows);
  Stored save_submap(const AtlasSubmap& owner, const Stored& before);
  bool remove_elements(const Submap& submap, const Stored& row);
  void save_keyframes(const Submap& submap, const Stored& row);
  void save_landmarks(const Submap& submap, const Stored& row);
  void save_poses(const Submap& submap, const Stored& row);
  bool save_placements(const Atlas& atlas, Deadline deadline, Rows* rows);
  void save_placement(const Placement& placement, int64_t row, const Rows& rows);
  void save_map(const Atlas& atlas, Rows* rows);
  bool remove_other_placements(Deadline deadline, Rows* rows);
  void save_links(const Atlas& atlas, const Rows& rows);
  void save_frames(const Atlas& atlas, const std::vector<ImageId>& frames);
  void save_masks(const Atlas& atlas);
  int64_t camera_row(const Camera& camera);
  Camera load_camera(int64_t row);
  void load_masks(Atlas* atlas);
  void load_submaps(Atlas* atlas);
  void load_elements(int64_t row, Submap* submap);
  void load_placements(Atlas* atlas, const std::map<int64_t, SubmapKey>& keys);
  void load_links(Atlas* atlas, const std::map<int64_t, SubmapKey>& keys);
  void give_back_pages();
  std::string explain(const SqliteError& error) const;
  std::string explain_busy() const;

  std::string file_;
  std::chrono::milliseconds wait_{};  // for other programs, before what is asked for fails
  int64_t bytes_ = 0;
  std::shared_ptr<std::atomic<bool>> copies_called_off_ = std::make_shared<std::atomic<bool>>(false);
  DatabaseLock lock_;
  Database db_;
  Rows stored_;
  std::vector<Link> stored_links_;
  std::map<int64_t, StillMask> stored_masks_;
  bool is_behind_ = false;
};

}  // namespace rumi::map_server
