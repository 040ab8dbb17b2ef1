// SPDX-License-Identifier: BSD-3-Clause
// map.db. If byte 0 is even, the rest is the file. If it is odd, the rest is a list of changes of 7 bytes each to the
// cells of a good file, because SQLite itself refuses most damaged files. A map_server serves what can be loaded.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/files/sqlite.h"
#include "bus/process/safe_node.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"
#include "map_server/map_server_node.h"
#include "map_server/outputs/output_files.h"

namespace rumi::fuzz {
namespace {

using namespace map_server;

constexpr size_t kChangeBytes = 7;
constexpr size_t kMostChanges = 8;

Bytes contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Bytes make_good_file() {
  const std::string file = scratch() / "good.db", copy = scratch() / "copy.db";
  Atlas atlas;
  for (const SubmapKey& key : {SubmapKey{kSession, 1}, SubmapKey{kSession, -1}}) {
    const submap_update_t update = make_submap_update(good_submap(key, 2), 0);
    const auto apply = [&](Submap* s) { return apply_submap_update(update, s); };
    if (!atlas.change_submap(key, apply)) throw std::logic_error("no good submap");
  }
  Placement placement;
  placement.map_from_submap[kSession + 100'000] = Sim3();
  placement.landmarks[0] = {1, 2, 3};
  placement.fused[1] = {{kSession, 1}, 2};
  atlas.place_map(PlacedMap::make({{{kSession, 1}, {}}, {{kSession, -1}, placement}}).value()).value();
  Link link;
  link.a = {kSession, 1};
  link.b = {kSession, -1};
  if (!atlas.set_links({link})) throw std::logic_error("no good link");
  atlas.record_frame({kSession + 100'000}, {.session = kSession, .state = TrackingState::kTracking, .submap_id = 1});
  {
    MapStore store = MapStore::open(file).value();
    if (!store.save(atlas, {ImageId{kSession + 100'000}}) || !store.write_copy(copy))
      throw std::logic_error("no good database");
  }
  return contents(copy);
}

const Bytes& good_file() {
  static const Bytes file = make_good_file();
  return file;
}

std::vector<std::string> column(Database& db, const std::string& sql) {
  std::vector<std::string> values;
  for (Statement rows(db, sql); rows.step();) {
    const View text = rows.blob(0);
    values.emplace_back(text.begin(), text.end());
  }
  return values;
}

std::string value_of(uint8_t kind, int16_t number, const std::string& old) {
  switch (kind % 12) {
    case 0:
      return std::to_string(number);
    case 1:
      return std::to_string(int64_t{number} << 16);
    case 2:
      return std::to_string(int64_t{number} << 48);
    case 3:
      return fmt::format("{}e{}", number % 100, number / 100);
    case 4:
      return "NULL";
    case 5:
      return "-1";
    case 6:
      return "9e999";
    case 7:
      return fmt::format("zeroblob({})", number & 0xff);
    case 8:
      return fmt::format("substr({}, {})", old, number & 0xff);
    case 9:
      return fmt::format("CAST({0} || {0} AS BLOB)", old);
    case 10:
      return fmt::format("CAST(substr({0}, 1, {1}) || x'{2:02x}' || substr({0}, {1} + 2) AS BLOB)", old, number & 0xff,
                         (number >> 8) & 0xff);
    default:
      return fmt::format("CAST(substr({0}, 1, 8 * {1}) || x'000000000000f87f' || substr({0}, 8 * {1} + 9) AS BLOB)",
                         old, number & 0xf);
  }
}

// Applies the 7 bytes of `change`: table, column, row, kind of the new value, a number for it (two bytes), and a byte
// that says whether the row is removed instead: if its lowest three bits are set.
void apply(Database& db, View change) {
  const std::vector<std::string> tables = column(db, "SELECT name FROM sqlite_master WHERE type = 'table'");
  if (tables.empty()) return;
  const std::string& table = tables[change[0] % tables.size()];
  const auto columns = column(db, fmt::format("SELECT name FROM pragma_table_info('{}')", table));
  auto keys = column(db, fmt::format("SELECT name FROM pragma_table_info('{}') WHERE pk > 0", table));
  if (keys.empty()) keys = {"rowid"};
  const std::string key = fmt::format("{}", fmt::join(keys, ", "));
  const std::string row =
      fmt::format("({}) = (SELECT {} FROM {} LIMIT 1 OFFSET {})", key, key, table, static_cast<int>(change[2] % 32));
  const std::string& name = columns[change[1] % columns.size()];
  const std::string value = value_of(change[3], static_cast<int16_t>(change[4] | change[5] << 8), name);
  if (change[6] % 8 == 7)
    db.execute(fmt::format("DELETE FROM {} WHERE {}", table, row));
  else
    db.execute(fmt::format("UPDATE {} SET {} = {} WHERE {}", table, name, value, row));
}

void write_changed(const std::string& file, View changes) {
  scratch().write("map.db", good_file());
  Database db(file);
  db.execute("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY; PRAGMA ignore_check_constraints = ON");
  for (size_t i = 0; i < kMostChanges && changes.size() >= kChangeBytes; ++i, changes = changes.subspan(kChangeBytes)) {
    try {
      apply(db, changes);
    } catch (const SqliteError&) {  // the change violates a constraint of the schema
    }
  }
}

void serve(const std::string& file) {
  MemoryBus bus;
  MapServerOptions options;
  options.database = file;
  options.merge.thread = false;
  SafeNode node(std::make_unique<MapServerNode>(bus, options), &bus.broken_handlers());
  Script asks;
  for (int8_t what = 0; what <= map_request_t::REGION; ++what)
    for (const SubmapKey& key : {SubmapKey{kSession, 1}, SubmapKey{kSession, -1}})
      if (what != map_request_t::SNAPSHOT) asks.push_back(message(0, good_request(what, key)));
  asks.push_back(payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap({kSession, 1}, 3), 0)));
  asks.push_back(pause(12));
  play(asks, {.bus = &bus, .node = &node, .channels = {channels::kMapRequest}, .chunk_channel = channels::kSubmap});
}

void run(View input) {
  if (input.empty()) return;
  const std::string file = scratch() / "map.db";
  for (const char* beside : {"-wal", "-shm", "-journal"}) std::filesystem::remove(file + beside);
  if (input[0] % 2 != 0)
    write_changed(file, input.subspan(1));
  else
    scratch().write("map.db", input.subspan(1));
  const Result<Atlas> atlas = load_atlas(file, std::chrono::milliseconds(0));
  if (!atlas) return;
  write_outputs(*atlas, scratch() / "outputs");
  try {
    serve(file);
  } catch (const std::runtime_error&) {  // map_server does not start with a file that it cannot use
  }
}

std::vector<Bytes> seeds() {
  Bytes whole = good_file();
  whole.insert(whole.begin(), 0);
  std::vector<Bytes> all{whole};
  for (uint8_t table = 0; table < 14; ++table)
    for (uint8_t kind = 0; kind < 12; kind += 3)
      all.push_back({1, table, static_cast<uint8_t>(kind + 1), 0, kind, 3, 1, 0});
  return all;
}

const Registered registered({"map_database", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
