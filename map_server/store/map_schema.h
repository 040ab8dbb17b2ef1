// SPDX-License-Identifier: BSD-3-Clause
// The schema of map.db, version 7. Anyone may read the file, even while map_server runs (`sqlite3 -readonly map.db`).
//
// Blobs are little endian. pose: 7 float64 w x y z tx ty tz. similarity: 8 float64 scale w x y z tx ty tz. Numbers
// whose every bit matters are stored as blobs, because SQLite turns -0.0 into 0. Times are microseconds since the
// epoch.
//
// Whoever changes a table raises kMapSchemaVersion and adds a step to kMapMigrations (map_migrations.cpp).
#pragma once

namespace rumi::map_server {

inline constexpr int kMapApplicationId = 0x52554d49;  // "RUMI", PRAGMA application_id
inline constexpr int kMapSchemaVersion = 7;           // PRAGMA user_version

// Submaps, as their makers sent them.
inline constexpr const char* kSubmapTables = R"sql(
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

// Where the submaps of the map lie in it. Only rows with revision = submaps.placement_revision are valid; others are
// being written or removed.
inline constexpr const char* kPlacementTables = R"sql(
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

inline constexpr const char* kLinksTable = R"sql(
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

inline constexpr const char* kFramesTable = R"sql(
CREATE TABLE frames (                     -- what front_tracker said when it saw the frame
  stream INTEGER NOT NULL,                -- as in submaps
  utime INTEGER NOT NULL,
  session INTEGER NOT NULL,
  state INTEGER NOT NULL,                 -- 0 NOT_INITIALIZED, 1 TRACKING, 2 RECENTLY_LOST, 3 LOST
  submap INTEGER NOT NULL,                -- submaps.id that it was tracked in, 0: in none
  PRIMARY KEY (stream, utime)
) WITHOUT ROWID;
)sql";

inline constexpr const char* kMasksTable = R"sql(
CREATE TABLE masks (                      -- what never moves in a camera's images (a bonnet, a caption), the newest
  stream INTEGER PRIMARY KEY,             -- as in submaps
  session INTEGER NOT NULL,               -- that it was learned in
  utime INTEGER NOT NULL,                 -- of the image at which it was learned so
  width INTEGER NOT NULL, height INTEGER NOT NULL,  -- pixels, of the images as they are worked on
  left_out REAL NOT NULL,                 -- share of the image, 0 to 1
  png BLOB NOT NULL                       -- of that size, black: left out; empty: nothing is
);
)sql";

}  // namespace rumi::map_server
