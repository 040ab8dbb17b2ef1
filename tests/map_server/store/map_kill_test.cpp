// SPDX-License-Identifier: BSD-3-Clause
// Kills a process at every stage of storing a map: updates, placements after a weld, removals by post-culling, free
// pages returned to the file system. The next process must find either the map before or the map after, complete, and
// be able to go on.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <tuple>

#include "map_server/store/map_store.h"
#include "tests/map_server/merging/map_maker.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/synthetic_chain.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

// Counts down the calls by which SQLite changes files. The last call is done only by half; then the process dies.
int calls_left = 0;
bool last_call() { return --calls_left == 0; }
void die() {
  raise(SIGKILL);
  std::abort();
}

ssize_t dying_pwrite(int file, const void* bytes, size_t count, off64_t at) {
  if (!last_call()) return ::pwrite64(file, bytes, count, at);
  if (::pwrite64(file, bytes, count / 2, at) >= 0) die();
  return -1;
}
ssize_t dying_write(int file, const void* bytes, size_t count) {
  if (!last_call()) return ::write(file, bytes, count);
  if (::write(file, bytes, count / 2) >= 0) die();
  return -1;
}
int dying_ftruncate(int file, off64_t size) {
  if (last_call()) die();
  return ::ftruncate64(file, size);
}
int dying_unlink(const char* name) {
  if (last_call()) die();
  return ::unlink(name);
}

void die_at_call(int number) {
  calls_left = number;
  sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
  const auto replace = [vfs](const char* name, auto* call) {
    return vfs->xSetSystemCall(vfs, name, reinterpret_cast<sqlite3_syscall_ptr>(call)) == SQLITE_OK;
  };
  // It depends on how SQLite was compiled which of the two names it uses.
  const bool ok = (replace("pwrite64", dying_pwrite) || replace("pwrite", dying_pwrite)) &&
                  replace("write", dying_write) && replace("ftruncate", dying_ftruncate) &&
                  replace("unlink", dying_unlink);
  if (!ok) _exit(3);
}

// Returns the atlas after each change that map_server stores, while a map grows, is welded, adjusted and culled.
std::vector<Atlas> history() {
  const Chain chain;
  std::vector<Atlas> stages;
  Atlas atlas;
  MapMaker maker;
  const auto build = [&](BuildScope scope) {
    BuildInput input{.submaps = {}, .scope = scope};
    for (const auto& [key, owner] : atlas.submaps()) {
      input.submaps[key] = &owner.submap;
      if (owner.in_map && owner.placement.revision > 0) input.placed[key] = owner.placement;
    }
    BuiltMap built = maker.build(input);
    EXPECT_TRUE(atlas.set_links(built.graph.links()));
    for (const auto& [key, left] : built.culled) put(*left, &atlas);
    testing::place_map(&atlas, std::move(built.placements), built.unmoved);
    stages.push_back(atlas);
    return built.culled.size();
  };
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) {
    put(chain.submap(key), &atlas);
    stages.push_back(atlas);
  }
  build(BuildScope::kWeld);
  EXPECT_GT(build(BuildScope::kAll), 0u) << "nothing was culled";
  for (const SubmapKey key : {Chain::kBack2, Chain::kFront3}) {
    put(chain.submap(key), &atlas);
    stages.push_back(atlas);
  }
  build(BuildScope::kWeld);
  EXPECT_GT(build(BuildScope::kAll), 0u) << "nothing was culled";
  return stages;
}

// Stores the stages in a child that dies at this call. Returns how many stages the child reported as stored, and
// whether it was killed.
std::pair<size_t, bool> store_until_killed(const std::vector<Atlas>& stages, const std::string& file, int call) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    MapStore store = MapStore::open(file).value();
    die_at_call(call);
    for (const Atlas& atlas : stages) {
      if (!store.save(atlas, {}).error_text().empty()) _exit(1);
      if (write(ends[1], "s", 1) != 1) _exit(2);
    }
    _exit(0);
  }
  close(ends[1]);
  size_t stored = 0;
  for (char byte = 0; read(ends[0], &byte, 1) == 1;) ++stored;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) != 0) << "it could not store, or could not say so";
  return {stored, WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL};
}

TEST(MapKill, AtEveryStageOfWritingTheMapIsWhole) {
  const std::vector<Atlas> stages = history();
  std::set<size_t> killed_in;
  int kills = 0;
  size_t stored = 0;
  // The calls tested are denser at the beginning, where stages need few calls, so that every stage is hit.
  for (int call = 1; stored < stages.size(); call += 1 + call / 20) {
    const TemporaryFolder folder;
    const std::string file = folder / "map.db";
    bool killed = false;
    std::tie(stored, killed) = store_until_killed(stages, file, call);
    if (!killed) {
      ASSERT_EQ(stored, stages.size());
      break;
    }
    ++kills;
    killed_in.insert(stored);
    MapStore store = MapStore::open(file).value();
    const Atlas found = store.load().value();
    // Finds the last stage reported, or the one that was being stored.
    size_t now = stored;
    if (now < stages.size() && found.revision() == stages[now].revision() &&
        found.submaps().size() == stages[now].submaps().size())
      ++now;
    SCOPED_TRACE("killed at call " + std::to_string(call) + ", " + std::to_string(now) + " stages stored");
    expect_same(now == 0 ? Atlas() : stages[now - 1], found);
    if (::testing::Test::HasFailure()) return;
    // The store goes on, and nothing remains of the crash.
    for (size_t i = now; i < stages.size(); ++i) ASSERT_EQ(store.save(stages[i], {}).error_text(), "");
    expect_same(stages.back(), store.load().value());
  }
  std::printf("killed %d times, in %zu of %zu stages\n", kills, killed_in.size(), stages.size());
  EXPECT_EQ(killed_in.size(), stages.size());
}

}  // namespace
}  // namespace rumi::testing
