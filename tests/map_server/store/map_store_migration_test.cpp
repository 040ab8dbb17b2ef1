// SPDX-License-Identifier: BSD-3-Clause
// Files of older schema versions are migrated completely or not at all.
#include <gmock/gmock.h>

#include "map_server/store/blob.h"
#include "map_server/store/map_schema.h"
#include "map_server/store/map_store.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/store/stored_atlas.h"

namespace rumi::map_server {
namespace {

using testing::expect_same;
using ::testing::HasSubstr;
using testing::make_submap;
using testing::TemporaryFolder;
using testing::update_atlas;

// The schema of version 1.
constexpr const char* kSchema1 = R"sql(
CREATE TABLE atlas (                      -- one row
  map_revision INTEGER NOT NULL           -- rises whenever anything of the served map changed
);
INSERT INTO atlas VALUES (0);

CREATE TABLE cameras (
  camera INTEGER PRIMARY KEY,
  model INTEGER NOT NULL,                 -- 0 pinhole (k1 k2 p1 p2 k3), 1 Kannala-Brandt fisheye (k1 k2 k3 k4)
  width INTEGER NOT NULL, height INTEGER NOT NULL,                                                 -- pixels
  fx REAL NOT NULL, fy REAL NOT NULL, cx REAL NOT NULL, cy REAL NOT NULL,                          -- pixels
  k1 REAL NOT NULL, k2 REAL NOT NULL, p1 REAL NOT NULL, p2 REAL NOT NULL, k3 REAL NOT NULL, k4 REAL NOT NULL,
  fps REAL NOT NULL                       -- nominal, 0 = unknown
);

CREATE TABLE submaps (
  submap INTEGER PRIMARY KEY,
  session INTEGER NOT NULL,               -- the run of front_tracker that made it
  id INTEGER NOT NULL,                    -- front: 1, 2, ...; back: -1, -2, ...
  kind INTEGER NOT NULL,                  -- 0 front, 1 back
  closed INTEGER NOT NULL,                -- 1: its maker adds nothing more
  revision INTEGER NOT NULL,
  camera INTEGER NOT NULL REFERENCES cameras,
  in_map INTEGER NOT NULL DEFAULT 0,      -- 1: part of the served map
  map_from_submap BLOB,                   -- similarity, where in_map
  UNIQUE (session, id)
);

CREATE TABLE keyframes (
  submap INTEGER NOT NULL REFERENCES submaps,
  id INTEGER NOT NULL,
  utime INTEGER NOT NULL,
  cam_from_submap BLOB NOT NULL,          -- pose
  revision INTEGER NOT NULL,              -- of the submap when this last changed
  created_revision INTEGER NOT NULL,
  PRIMARY KEY (submap, id)
) WITHOUT ROWID;

CREATE TABLE features (                   -- of a keyframe; written once
  submap INTEGER NOT NULL REFERENCES submaps,
  keyframe INTEGER NOT NULL,
  keypoints BLOB NOT NULL,                -- n x 3 float32: x, y (pixels as detected), angle (radians)
  octaves BLOB NOT NULL,                  -- n uint8
  descriptors BLOB NOT NULL,              -- n x 32 bytes
  PRIMARY KEY (submap, keyframe)
);

CREATE TABLE observations (               -- of a keyframe
  submap INTEGER NOT NULL REFERENCES submaps,
  keyframe INTEGER NOT NULL,
  pairs BLOB NOT NULL,                    -- m x 2 int32: this keypoint (index) sees this landmark (id)
  PRIMARY KEY (submap, keyframe)
);

CREATE TABLE landmarks (
  submap INTEGER NOT NULL REFERENCES submaps,
  id INTEGER NOT NULL,
  position BLOB NOT NULL,                 -- 3 float64, in the submap
  descriptor BLOB NOT NULL,               -- 32 bytes
  revision INTEGER NOT NULL,
  PRIMARY KEY (submap, id)
) WITHOUT ROWID;

CREATE TABLE removed (                    -- so that a copy elsewhere can be told
  submap INTEGER NOT NULL REFERENCES submaps,
  what INTEGER NOT NULL,                  -- 0 keyframe, 1 landmark
  id INTEGER NOT NULL,
  revision INTEGER NOT NULL,
  PRIMARY KEY (submap, what, id)
) WITHOUT ROWID;

CREATE TABLE frame_poses (                -- cam_from_submap = cam_from_keyframe * keyframe.cam_from_submap
  submap INTEGER NOT NULL REFERENCES submaps,
  utime INTEGER NOT NULL,
  reference_keyframe INTEGER NOT NULL,
  cam_from_keyframe BLOB NOT NULL,        -- pose
  revision INTEGER NOT NULL,
  PRIMARY KEY (submap, utime)
) WITHOUT ROWID;

CREATE TABLE frames (                     -- what front_tracker said when it saw the frame
  utime INTEGER PRIMARY KEY,
  session INTEGER NOT NULL,
  state INTEGER NOT NULL,                 -- 0 NOT_INITIALIZED, 1 TRACKING, 2 RECENTLY_LOST, 3 LOST
  submap INTEGER NOT NULL                 -- submaps.id that it was tracked in, -1: in none
);
)sql";

// Writes those parts of the atlas that version 1 could store, with its schema. Tables that have not changed since are
// copied from a file of the current version.
void write_version_1(const Atlas& atlas, const std::string& file, const Sim3& map_from_submap) {
  const std::string present = file + ".present";
  {
    MapStore store = MapStore::open(present).value();
    std::vector<ImageId> images;
    for (const auto& [image, record] : atlas.frames()) images.push_back(image);
    ASSERT_EQ(store.save(atlas, images).error_text(), "");
  }
  Database database(file);
  database.execute(kSchema1);
  Statement(database, "ATTACH ? AS present").bind(present).run();
  database.execute("DELETE FROM atlas");
  for (const std::string table : {"atlas", "cameras", "keyframes", "features", "observations", "landmarks"})
    database.execute("INSERT INTO main." + table + " SELECT * FROM present." + table);
  database.execute("INSERT INTO main.frames SELECT utime, session, state, submap FROM present.frames");
  database.execute(
      "INSERT INTO main.frame_poses SELECT submap, utime, reference_keyframe, cam_from_keyframe, revision FROM "
      "present.frame_poses");
  const SimilarityNumbers numbers = similarity_numbers(map_from_submap);
  Statement(database,
            "INSERT INTO main.submaps SELECT submap, session, id, kind, closed, revision, camera, in_map, ? "
            "FROM present.submaps")
      .bind(as_blob(numbers))
      .run();
  database.execute("PRAGMA application_id = 1381322057; PRAGMA user_version = 1");
}

// Versions before 4 had no standard deviations, and versions before 5 had only one pyramid.
Submap without_sigmas(Submap submap) {
  submap.pyramid = {};
  submap.frames.change_all([](FramePose* frame) { frame->sigmas = {}; });
  return submap;
}

// Versions before 7 had no masks.
void drop_masks(const std::string& file) { Database(file).execute("DROP TABLE masks"); }

// Versions before 6 identified frames by their times alone.
void drop_streams(const std::string& file) {
  drop_masks(file);
  Database(file).execute(R"sql(
    CREATE TABLE f (utime INTEGER PRIMARY KEY, session INTEGER NOT NULL, state INTEGER NOT NULL,
                    submap INTEGER NOT NULL);
    INSERT INTO f SELECT utime, session, state, submap FROM frames;
    DROP TABLE frames;
    ALTER TABLE f RENAME TO frames;
    ALTER TABLE submaps DROP COLUMN stream;)sql");
}

void drop_pyramids(const std::string& file) {
  drop_streams(file);
  for (const std::string column : {"levels", "scale_factor"})
    Database(file).execute("ALTER TABLE submaps DROP COLUMN " + column);
}

void drop_sigmas(const std::string& file) {
  drop_pyramids(file);
  for (const std::string column : {"position_sigma", "rotation_sigma_rad", "log_scale_sigma"})
    Database(file).execute("ALTER TABLE frame_poses DROP COLUMN " + column);
}

// Versions before 5 had one placement per submap.
void drop_placement_revisions(const std::string& file) {
  Database(file).execute(R"sql(
    CREATE TABLE k (submap INTEGER NOT NULL, utime INTEGER NOT NULL, map_from_submap BLOB NOT NULL,
                    PRIMARY KEY (submap, utime)) WITHOUT ROWID;
    CREATE TABLE l (submap INTEGER NOT NULL, id INTEGER NOT NULL, position BLOB NOT NULL,
                    PRIMARY KEY (submap, id)) WITHOUT ROWID;
    CREATE TABLE f (submap INTEGER NOT NULL, id INTEGER NOT NULL, into_submap INTEGER NOT NULL,
                    into_id INTEGER NOT NULL, PRIMARY KEY (submap, id)) WITHOUT ROWID;
    INSERT INTO k SELECT submap, utime, map_from_submap FROM placed_keyframes;
    INSERT INTO l SELECT submap, id, position FROM placed_landmarks;
    INSERT INTO f SELECT submap, id, into_submap, into_id FROM fused_landmarks;
    DROP TABLE placed_keyframes; DROP TABLE placed_landmarks; DROP TABLE fused_landmarks;
    ALTER TABLE k RENAME TO placed_keyframes;
    ALTER TABLE l RENAME TO placed_landmarks;
    ALTER TABLE f RENAME TO fused_landmarks;)sql");
}

// A migrated file has a stream of its own for each session.
Submap old_submap(int32_t id, int steps, int64_t first_utime_us = 1'000'000) {
  Submap submap = make_submap({7, id}, static_cast<uint32_t>(id), steps, first_utime_us);
  submap.stream = 7;
  return submap;
}

Atlas old_atlas() {
  Atlas atlas;
  update_atlas(&atlas, without_sigmas(old_submap(1, 12)));
  update_atlas(&atlas, without_sigmas(old_submap(2, 5, 9'000'000)));
  atlas.record_frame({500'000, 7}, {.session = 7, .state = TrackingState::kNotInitialized});
  return atlas;
}

std::string columns(const std::string& file) {
  Database database(file);
  std::string all;
  Statement tables(database, "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name");
  while (tables.step()) {
    const std::span<const uint8_t> bytes = tables.blob(0);
    const std::string name(bytes.begin(), bytes.end());
    all += name + ": " +
           database.text(
               "SELECT group_concat(name || ' ' || type || ' ' || \"notnull\" || ' ' || pk) FROM "
               "pragma_table_info('" +
               name + "')") +
           "\n";
  }
  return all;
}

// Expects map.db to have the same tables as a new file.
void expect_present_version(const TemporaryFolder& folder) {
  { MapStore store = MapStore::open(folder / "fresh.db").value(); }
  EXPECT_EQ(columns(folder / "map.db"), columns(folder / "fresh.db"));
  EXPECT_EQ(Database(folder / "map.db").integer("PRAGMA user_version"), kMapSchemaVersion);
}

TEST(MapStoreMigration, AFileOfVersion1IsTakenOver) {
  const TemporaryFolder folder;
  Atlas atlas = old_atlas();
  write_version_1(atlas, folder / "map.db", Sim3());
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
    update_atlas(&atlas, old_submap(1, 14));  // the migrated map can grow
    testing::place_map(&atlas, {{{7, 2}, testing::make_placement(atlas.find({7, 2})->submap, 1)}});
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  }
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
  }
  expect_present_version(folder);
}

TEST(MapStoreMigration, AFileOfVersion2IsTakenOver) {
  const TemporaryFolder folder;
  const Atlas atlas = old_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {{500'000, 7}}).error_text(), "");
  }
  drop_sigmas(folder / "map.db");
  drop_placement_revisions(folder / "map.db");
  Database(folder / "map.db")
      .execute(
          "CREATE TABLE removed (submap INTEGER NOT NULL REFERENCES submaps, what INTEGER NOT NULL, id INTEGER NOT "
          "NULL, revision INTEGER NOT NULL, PRIMARY KEY (submap, what, id)) WITHOUT ROWID;"
          "INSERT INTO removed VALUES (1, 1, 5, 3); PRAGMA user_version = 2");
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
  }
  expect_present_version(folder);
}

// The poses are kept, with unknown standard deviations; those of new poses are known.
TEST(MapStoreMigration, AFileOfVersion3IsTakenOver) {
  const TemporaryFolder folder;
  Atlas atlas = old_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {{500'000, 7}}).error_text(), "");
  }
  drop_sigmas(folder / "map.db");
  drop_placement_revisions(folder / "map.db");
  Database(folder / "map.db").execute("PRAGMA user_version = 3");
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
    update_atlas(&atlas, old_submap(1, 14));  // the migrated map can grow
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  }
  const Atlas loaded = MapStore::open(folder / "map.db").value().load().value();
  expect_same(atlas, loaded);
  EXPECT_TRUE(loaded.find({7, 1})->submap.frames.rbegin()->second.sigmas.are_known());
  EXPECT_FALSE(loaded.find({7, 2})->submap.frames.rbegin()->second.sigmas.are_known());
  expect_present_version(folder);
}

TEST(MapStoreMigration, AFileOfVersion4IsTakenOver) {
  const TemporaryFolder folder;
  Atlas atlas = old_atlas();
  std::map<SubmapKey, Placement> placements;
  for (const auto& [key, owner] : atlas.submaps()) placements[key] = testing::make_placement(owner.submap, 1);
  placements[{7, 1}].fused[3] = {{7, 2}, 5};
  testing::place_map(&atlas, placements);
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {{500'000, 7}}).error_text(), "");
  }
  drop_placement_revisions(folder / "map.db");
  drop_pyramids(folder / "map.db");
  Database(folder / "map.db").execute("PRAGMA user_version = 4");
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
    testing::place_map(&atlas, {{{7, 2}, testing::make_placement(atlas.find({7, 2})->submap, 2)}});  // a change
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
    expect_same(atlas, store.load().value());
  }
  expect_present_version(folder);
}

TEST(MapStoreMigration, AFileOfVersion5IsTakenOver) {
  const TemporaryFolder folder;
  Atlas atlas = old_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {{500'000, 7}}).error_text(), "");
  }
  drop_streams(folder / "map.db");
  Database(folder / "map.db").execute("PRAGMA user_version = 5");
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
    // A recording with the same times is added to it.
    Submap other = make_submap({8, 1}, 3, 4);
    other.stream = 123;
    update_atlas(&atlas, other);
    atlas.record_frame({500'000, 123}, {.session = 8, .state = TrackingState::kLost});
    ASSERT_EQ(store.save(atlas, {{500'000, 123}}).error_text(), "");
    expect_same(atlas, store.load().value());
  }
  expect_present_version(folder);
}

TEST(MapStoreMigration, AFileOfVersion6IsTakenOver) {
  const TemporaryFolder folder;
  Atlas atlas = testing::merged_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, testing::all_frames(atlas)).error_text(), "");
  }
  drop_masks(folder / "map.db");
  Database(folder / "map.db").execute("PRAGMA user_version = 6");
  EXPECT_EQ(load_atlas(folder / "map.db").value().frames(), atlas.frames()) << "read, and left as it is";
  EXPECT_EQ(Database(folder / "map.db").integer("PRAGMA user_version"), 6);
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    Atlas loaded = store.load().value();
    EXPECT_TRUE(loaded.masks().empty());
    loaded.record_mask(9, atlas.masks().at(9));  // the migrated map can take masks
    ASSERT_EQ(store.save(loaded, {}).error_text(), "");
  }
  expect_same(atlas, MapStore::open(folder / "map.db").value().load().value());
  expect_present_version(folder);
}

TEST(MapStoreMigration, ADeviationThatIsNoneIsNotKnown) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 2));
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  }
  Database(folder / "map.db").execute("UPDATE frame_poses SET position_sigma = 1e999, log_scale_sigma = -3");
  const Atlas loaded = MapStore::open(folder / "map.db").value().load().value();
  for (const auto& [utime_us, frame] : loaded.find({7, 1})->submap.frames) EXPECT_EQ(frame.sigmas, PoseSigmas());
}

TEST(MapStoreMigration, ASimilarityOfVersion1BecomesAPlacement) {
  const TemporaryFolder folder;
  const Sim3 map_from_submap(2.5, so3_exp({0.1, -0.7, 0.3}), Eigen::Vector3d(4, 5, 6));
  const Atlas atlas = old_atlas();
  write_version_1(atlas, folder / "map.db", map_from_submap);
  MapStore store = MapStore::open(folder / "map.db").value();
  const Atlas loaded = store.load().value();
  EXPECT_TRUE(loaded.find({7, 1})->in_map);
  Placement expected;
  expected.map_from_submap[loaded.find({7, 1})->submap.keyframes.begin()->second.utime_us] = map_from_submap;
  expected.revision = atlas.revision();
  expect_same(expected, loaded.find({7, 1})->placement);
  expect_same(Placement(), loaded.find({7, 2})->placement);  // the submap is not in the map
}

TEST(MapStoreMigration, WhatCannotBeBroughtOverIsLeftAsItIs) {
  const TemporaryFolder folder;
  write_version_1(old_atlas(), folder / "map.db", Sim3());
  Database(folder / "map.db").execute("CREATE TABLE links (x)");  // prevents the migration
  EXPECT_THAT(MapStore::open(folder / "map.db").error_text(), HasSubstr("map.db"));
  Database database(folder / "map.db");
  EXPECT_EQ(database.integer("PRAGMA user_version"), 1);
  EXPECT_EQ(database.integer("SELECT count(*) FROM sqlite_master WHERE name LIKE 'placed%'"), 0);
  EXPECT_EQ(database.integer("SELECT count(map_from_submap) FROM submaps"), 2);
}

}  // namespace
}  // namespace rumi::map_server
