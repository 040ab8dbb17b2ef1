// SPDX-License-Identifier: BSD-3-Clause
// The schema of map.db, version 7. Anyone may read the file, also while map_server runs (`sqlite3 -readonly map.db`).
//
// Blobs are little endian. pose: 7 float64 w x y z tx ty tz. similarity: 8 float64 scale w x y z tx ty tz. Numbers are
// kept as blobs where every bit counts (SQLite turns -0.0 into 0). Times are microseconds since the epoch.
#pragma once

namespace rumi::map_server {

inline constexpr int kMapApplicationId = 0x52554d49;  // "RUMI", PRAGMA application_id
inline constexpr int kMapSchemaVersion = 7;           // PRAGMA user_version; raise it with every change of the schema

// What version 2 added to version 1: where the submaps of the map lie in it. Since version 5 with the revision: rows of
// another one than submaps.placement_revision are on their way in or out, and do not count.
inline constexpr const char* kMapSchemaPlacements = R"sql(
CREATE TABLE placed_keyframes (           -- a submap of the map bends with its keyframes
  submap INTEGER NOT NULL REFERENCES submaps,
  revision INTEGER NOT NULL,
  utime INTEGER NOT NULL,                 -- of the keyframe
  map_from_submap BLOB NOT NULL,          -- similarity
  PRIMARY KEY (submap, revision, utime)
) WITHOUT ROWID;

CREATE TABLE placed_landmarks (           -- those that do not just follow their keyframe
  submap INTEGER NOT NULL REFERENCES submaps,
  revision INTEGER NOT NULL,
  id INTEGER NOT NULL,
  position BLOB NOT NULL,                 -- 3 float64, in the map
  PRIMARY KEY (submap, revision, id)
) WITHOUT ROWID;

CREATE TABLE fused_landmarks (            -- these are the same point as another landmark
  submap INTEGER NOT NULL REFERENCES submaps,
  revision INTEGER NOT NULL,
  id INTEGER NOT NULL,
  into_submap INTEGER NOT NULL REFERENCES submaps (submap),
  into_id INTEGER NOT NULL,
  PRIMARY KEY (submap, revision, id)
) WITHOUT ROWID;
)sql";

// What else it added.
inline constexpr const char* kMapSchemaLinks = R"sql(
CREATE TABLE links (                      -- attempts to align two submaps
  link INTEGER PRIMARY KEY,
  a INTEGER NOT NULL REFERENCES submaps (submap),
  b INTEGER NOT NULL REFERENCES submaps (submap),
  kind INTEGER NOT NULL,                  -- compared by: 0 images that both were made of, 1 appearance
  b_from_a BLOB NOT NULL,                 -- similarity
  keyframes INTEGER NOT NULL, keyframe_inliers INTEGER NOT NULL,    -- in common, and those that agree
  landmarks INTEGER NOT NULL, landmark_inliers INTEGER NOT NULL,
  rmse_px REAL NOT NULL,                  -- of the inliers
  accepted INTEGER NOT NULL,
  doubt TEXT NOT NULL,                    -- why it is not accepted
  revision INTEGER NOT NULL               -- of the map when the links last changed
);
)sql";

// All else.
inline constexpr const char* kMapSchema = R"sql(
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
  placement_revision INTEGER NOT NULL DEFAULT 0,  -- of the map when its place there last changed; 0: never placed
  levels INTEGER NOT NULL DEFAULT 8,      -- of the pyramid that octaves are levels of,
  scale_factor REAL NOT NULL DEFAULT 1.2, -- and the size of a level's pixels over that of the level below
  stream INTEGER NOT NULL DEFAULT 0,      -- the camera or recording that its images are of
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

CREATE TABLE frame_poses (                -- cam_from_submap = cam_from_keyframe * keyframe.cam_from_submap
  submap INTEGER NOT NULL REFERENCES submaps,
  utime INTEGER NOT NULL,
  reference_keyframe INTEGER NOT NULL,
  cam_from_keyframe BLOB NOT NULL,        -- pose
  revision INTEGER NOT NULL,
  position_sigma REAL,                    -- standard deviations, as in track.lcm, in the submap's unit; NULL: not known
  rotation_sigma_rad REAL,
  log_scale_sigma REAL,
  PRIMARY KEY (submap, utime)
) WITHOUT ROWID;

)sql";

// Until version 5 a frame was a time, whatever it was an image of.
inline constexpr const char* kMapSchemaFrames = R"sql(
CREATE TABLE frames (                     -- what front_tracker said when it saw the frame
  stream INTEGER NOT NULL,                -- as in submaps
  utime INTEGER NOT NULL,
  session INTEGER NOT NULL,
  state INTEGER NOT NULL,                 -- 0 NOT_INITIALIZED, 1 TRACKING, 2 RECENTLY_LOST, 3 LOST
  submap INTEGER NOT NULL,                -- submaps.id that it was tracked in, 0: in none
  PRIMARY KEY (stream, utime)
) WITHOUT ROWID;
)sql";

// What version 7 added to version 6.
inline constexpr const char* kMapSchemaMasks = R"sql(
CREATE TABLE masks (                      -- what never moves in a camera's images (a bonnet, a caption), the newest
  stream INTEGER PRIMARY KEY,             -- as in submaps
  session INTEGER NOT NULL,               -- that it was learned in
  utime INTEGER NOT NULL,                 -- of the image at which it was learned so
  width INTEGER NOT NULL, height INTEGER NOT NULL,  -- pixels, of the images as they are worked on
  left_out REAL NOT NULL,                 -- share of the image, 0 to 1
  png BLOB NOT NULL                       -- of that size, black: left out; empty: nothing is
);
)sql";

// Version 1 had one similarity for a whole submap, of which only the identity (the blob below) was ever written; any
// other becomes that of its first keyframe, which all others then follow.
inline constexpr const char* kMapSchemaFrom1To2 = R"sql(
ALTER TABLE submaps ADD COLUMN placement_revision INTEGER NOT NULL DEFAULT 0;
INSERT INTO placed_keyframes
  SELECT s.submap, (SELECT max(map_revision, 1) FROM atlas), min(k.utime), s.map_from_submap
  FROM submaps s JOIN keyframes k ON k.submap = s.submap
  WHERE s.in_map AND s.map_from_submap <>
    x'000000000000F03F000000000000F03F000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000'
  GROUP BY s.submap;
UPDATE submaps SET placement_revision = (SELECT max(map_revision, 1) FROM atlas)
  WHERE submap IN (SELECT submap FROM placed_keyframes);
ALTER TABLE submaps DROP COLUMN map_from_submap;
)sql";

// Version 2 kept what had been removed, without end.
inline constexpr const char* kMapSchemaFrom2To3 = "DROP TABLE removed";

// Version 3 did not know how well poses are known.
inline constexpr const char* kMapSchemaFrom3To4 = R"sql(
ALTER TABLE frame_poses ADD COLUMN position_sigma REAL;
ALTER TABLE frame_poses ADD COLUMN rotation_sigma_rad REAL;
ALTER TABLE frame_poses ADD COLUMN log_scale_sigma REAL;
)sql";

// Version 4 had one placement of a submap, to be replaced in one go. Before and after kMapSchemaPlacements.
inline constexpr const char* kMapSchemaFrom4 = R"sql(
ALTER TABLE placed_keyframes RENAME TO placed_keyframes_4;
ALTER TABLE placed_landmarks RENAME TO placed_landmarks_4;
ALTER TABLE fused_landmarks RENAME TO fused_landmarks_4;
)sql";
inline constexpr const char* kMapSchemaTo5 = R"sql(
INSERT INTO placed_keyframes SELECT p.submap, s.placement_revision, p.utime, p.map_from_submap
  FROM placed_keyframes_4 p JOIN submaps s ON s.submap = p.submap;
INSERT INTO placed_landmarks SELECT p.submap, s.placement_revision, p.id, p.position
  FROM placed_landmarks_4 p JOIN submaps s ON s.submap = p.submap;
INSERT INTO fused_landmarks SELECT p.submap, s.placement_revision, p.id, p.into_submap, p.into_id
  FROM fused_landmarks_4 p JOIN submaps s ON s.submap = p.submap;
DROP TABLE placed_keyframes_4;
DROP TABLE placed_landmarks_4;
DROP TABLE fused_landmarks_4;
)sql";

// Versions before 5 knew one pyramid only.
inline constexpr const char* kMapSchemaPyramids = R"sql(
ALTER TABLE submaps ADD COLUMN levels INTEGER NOT NULL DEFAULT 8;
ALTER TABLE submaps ADD COLUMN scale_factor REAL NOT NULL DEFAULT 1.2;
)sql";

// Versions before 6 did not know which images a session was of: each has a stream of its own. Before and after
// kMapSchemaFrames.
inline constexpr const char* kMapSchemaFrom5 = R"sql(
ALTER TABLE submaps ADD COLUMN stream INTEGER NOT NULL DEFAULT 0;
UPDATE submaps SET stream = session;
ALTER TABLE frames RENAME TO frames_5;
)sql";
inline constexpr const char* kMapSchemaTo6 = R"sql(
INSERT INTO frames SELECT session, utime, session, state, submap FROM frames_5;
DROP TABLE frames_5;
)sql";

}  // namespace rumi::map_server
