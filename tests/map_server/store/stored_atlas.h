// SPDX-License-Identifier: BSD-3-Clause
// Atlases with content for every table of the file, and a function that returns why a file cannot be opened.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "map_server/store/map_store.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {

inline std::string open_error(const std::string& file) {
  Result<MapStore> store = MapStore::open(file);
  return store ? store->load().error_text() : store.error().text();
}

inline Atlas full_atlas() {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 12));
  update_atlas(&atlas, make_submap({7, 2}, 2, 5, 9'000'000));
  Submap of_another_stream = make_submap({8, -1}, 3, 3, 12'000'000);
  of_another_stream.stream = 9;
  update_atlas(&atlas, of_another_stream);
  atlas.record_frame({1'000'000, 9}, {.session = 8, .state = TrackingState::kLost});
  atlas.record_frame({500'000}, {.session = 7, .state = TrackingState::kNotInitialized});
  atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1});
  atlas.record_mask(9, make_mask(8, 12'000'000, 8));
  return atlas;
}

// Submaps 1 and -1 are the map, and bend; there are links between all pairs.
inline Atlas merged_atlas() {
  Atlas atlas = full_atlas();
  std::map<SubmapKey, Placement> placements;
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{8, -1}})
    placements[key] = make_placement(atlas.find(key)->submap, 4);
  for (int id = 0; id < 5; ++id) placements[{7, 1}].fused[100 + id] = {{8, -1}, 7 * id};
  testing::place_map(&atlas, placements);
  EXPECT_TRUE(
      atlas.set_links({{.a = {7, 1},
                        .b = {8, -1},
                        .kind = Link::Kind::kSameImages,
                        .b_from_a = Sim3(0.3, so3_exp({1, 2, 3}), {4, -0.0, 6}),
                        .keyframes = 12,
                        .keyframe_inliers = 11,
                        .landmarks = 300,
                        .landmark_inliers = 290,
                        .rmse_px = 0.7,
                        .doubt = ""},
                       {.a = {7, 1}, .b = {8, -1}, .kind = Link::Kind::kAppearance, .doubt = "3 of 50 landmarks agree"},
                       {.a = {7, 2}, .b = {8, -1}, .doubt = "no 'image' in common"}}));
  return atlas;
}

inline std::vector<ImageId> all_frames(const Atlas& atlas) {
  std::vector<ImageId> images;
  for (const auto& [image, record] : atlas.frames()) images.push_back(image);
  return images;
}

}  // namespace rumi::testing
