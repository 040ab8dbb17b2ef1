// SPDX-License-Identifier: BSD-3-Clause
#include "tests/map_server/test_atlas.h"
#include "tests/map_server/place_map.h"

#include <fmt/format.h>

#include <cstring>
#include <opencv2/core/mat.hpp>

#include "bus/wire/image_masks.h"
#include "bus/wire/submap_update.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

constexpr int kKeypoints = 40;
constexpr int64_t kFramePeriodUs = 33'333;

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

bool same_pose(const SE3& a, const SE3& b) {
  return std::memcmp(a.rotation.coeffs().data(), b.rotation.coeffs().data(), 4 * sizeof(double)) == 0 &&
         std::memcmp(a.translation.data(), b.translation.data(), 3 * sizeof(double)) == 0;
}

bool same_features(const Features& a, const Features& b) {
  if (a.descriptors != b.descriptors || a.keypoints.size() != b.keypoints.size()) return false;
  for (size_t i = 0; i < a.keypoints.size(); ++i)
    if (a.keypoints[i].pixel != b.keypoints[i].pixel || a.keypoints[i].octave != b.keypoints[i].octave ||
        !same_bits(a.keypoints[i].angle_rad, b.keypoints[i].angle_rad))
      return false;
  return true;
}

}  // namespace

Camera test_camera() {
  Camera c;
  c.width = 640, c.height = 480;
  c.fx = 525.25, c.fy = 524.75, c.cx = 319.5, c.cy = 239.5;
  c.k1 = 0.1, c.k2 = -0.02, c.p1 = 0.001, c.p2 = -0.0005;
  c.fps = 30;
  return c;
}

SubmapMaker::SubmapMaker(SubmapKey key, uint32_t seed, int64_t first_utime_us)
    : random_(seed), next_utime_us_(first_utime_us) {
  submap_.key = key;
  submap_.kind = key.id > 0 ? SubmapKind::kFront : SubmapKind::kBack;
  submap_.camera = test_camera();
  submap_.pyramid = {8, key.id == 2 ? 1.25 : 1.2};
}

SE3 SubmapMaker::random_pose() {
  const Eigen::Vector3d axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
  return {so3_exp(axis), Eigen::Vector3d(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3))};
}

int SubmapMaker::add_keyframe() {
  auto features = std::make_shared<Features>();
  for (int i = 0; i < kKeypoints; ++i) {
    features->keypoints.push_back({{static_cast<float>(uniform(0, 639)), static_cast<float>(uniform(0, 479))},
                                   static_cast<float>(uniform(-3, 3)),
                                   static_cast<uint8_t>(random_() % 8)});
    Descriptor& d = features->descriptors.emplace_back();
    for (auto& word : d) word = (static_cast<uint64_t>(random_()) << 32) | random_();
  }
  Keyframe keyframe;
  keyframe.id = next_keyframe_++;
  keyframe.utime_us = next_utime_us_;
  keyframe.cam_from_submap = random_pose();
  keyframe.features = features;
  keyframe.landmark_ids.assign(kKeypoints, kNone);
  keyframe.revision = keyframe.created_revision = submap_.revision;
  submap_.keyframes[keyframe.id] = keyframe;
  return keyframe.id;
}

void SubmapMaker::add_landmark() {
  Landmark landmark;
  landmark.id = next_landmark_++;
  landmark.position = {uniform(-5, 5), -0.0, uniform(1, 9)};
  for (auto& word : landmark.descriptor) word = (static_cast<uint64_t>(random_()) << 32) | random_();
  landmark.revision = submap_.revision;
  submap_.landmarks[landmark.id] = landmark;
  for (auto& [id, keyframe] : submap_.keyframes)
    if (random_() % 2 == 0) submap_.add_observation(landmark.id, id, static_cast<int>(random_() % kKeypoints));
}

void SubmapMaker::step() {
  ++submap_.revision;
  const int keyframe = add_keyframe();
  for (int i = 0; i < 4; ++i) {
    const SE3 pose = i == 0 ? SE3() : random_pose();
    // The first pose has unknown sigmas. They are computed, because drawing random numbers would change all submaps.
    const auto length = static_cast<float>(pose.translation.norm());
    const PoseSigmas sigmas = i == 0 ? PoseSigmas() : PoseSigmas{length, 0.1F * length, 0.01F * length};
    submap_.frames.set({next_utime_us_, keyframe, pose, submap_.revision, sigmas});
    next_utime_us_ += kFramePeriodUs;
  }
  for (int i = 0; i < 15; ++i) add_landmark();
  for (auto& [id, landmark] : submap_.landmarks) {
    if (random_() % 5 != 0) continue;
    submap_.move_landmark(id, landmark.position + Eigen::Vector3d(0.01, 0, 0));
  }
  if (submap_.landmarks.size() > 20) submap_.remove_landmark(submap_.landmarks.begin()->first);
  if (submap_.keyframes.size() > 4 && random_() % 3 == 0) {
    const int oldest = submap_.keyframes.begin()->first;
    submap_.remove_keyframe(oldest, submap_.keyframes.rbegin()->first);
  }
}

Submap make_submap(SubmapKey key, uint32_t seed, int steps, int64_t first_utime_us) {
  SubmapMaker maker(key, seed, first_utime_us);
  for (int i = 0; i < steps; ++i) maker.step();
  return maker.submap();
}

void update_atlas(Atlas* atlas, const Submap& submap) {
  const AtlasSubmap* known = atlas->find(submap.key);
  const submap_update_t update = make_submap_update(submap, known ? known->submap.revision : 0);
  ASSERT_EQ(atlas->change_submap(submap.key, [&](Submap* s) { return apply_submap_update(update, s); }).error_text(),
            "");
}

Placement make_placement(const Submap& submap, uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&random] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const auto vector = [&number] { return Eigen::Vector3d(number(), -0.0, number()); };
  Placement placement;
  for (const auto& [id, keyframe] : submap.keyframes)
    placement.map_from_submap[keyframe.utime_us] = Sim3(std::exp(number()), so3_exp(vector()), vector());
  if (placement.map_from_submap.size() > 1) placement.map_from_submap.erase(placement.map_from_submap.rbegin()->first);
  for (const auto& [id, landmark] : submap.landmarks)
    if (id % 3 == 0) placement.landmarks[id] = vector();
  return placement;
}

track_t make_track(int64_t utime_us, int64_t session, int8_t state, int32_t submap_id, bool is_keyframe) {
  track_t track{};
  track.utime = utime_us;
  track.session = session;
  track.state = state;
  track.submap_id = submap_id;
  track.reference_keyframe = kNone;
  track.is_keyframe = is_keyframe;
  return track;
}

void expect_same(const Submap& a, const Submap& b) {
  SCOPED_TRACE(fmt::format("submap {}", a.key.id));
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.closed, b.closed);
  EXPECT_EQ(a.pyramid, b.pyramid);
  EXPECT_EQ(a.stream, b.stream);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.camera.k1, b.camera.k1);
  EXPECT_EQ(a.camera.cx, b.camera.cx);
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (const auto& [id, x] : a.keyframes) {
    const Keyframe* y = b.keyframe(id);
    ASSERT_NE(y, nullptr) << "keyframe " << id;
    EXPECT_TRUE(x.utime_us == y->utime_us && same_pose(x.cam_from_submap, y->cam_from_submap) &&
                x.landmark_ids == y->landmark_ids && x.revision == y->revision &&
                x.created_revision == y->created_revision && same_features(*x.features, *y->features))
        << "keyframe " << id;
  }
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (const auto& [id, x] : a.landmarks) {
    const Landmark* y = b.landmark(id);
    ASSERT_NE(y, nullptr) << "landmark " << id;
    EXPECT_TRUE(same_bits(x.position, y->position) && x.descriptor == y->descriptor && x.revision == y->revision);
    ASSERT_EQ(x.observations.size(), y->observations.size());
    for (size_t i = 0; i < x.observations.size(); ++i)
      EXPECT_TRUE(x.observations[i].keyframe_id == y->observations[i].keyframe_id &&
                  x.observations[i].keypoint_index == y->observations[i].keypoint_index);
  }
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (const auto& [utime, x] : a.frames) {
    const FramePose* y = b.frame(utime);
    ASSERT_NE(y, nullptr) << "frame " << utime;
    EXPECT_TRUE(x.reference_keyframe == y->reference_keyframe && x.revision == y->revision &&
                same_pose(x.cam_from_keyframe, y->cam_from_keyframe) && x.sigmas == y->sigmas);
  }
}

void expect_same(const Placement& a, const Placement& b) {
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_TRUE(same_place(a, b));
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (const auto& [id, position] : a.landmarks) {
    ASSERT_TRUE(b.landmarks.contains(id)) << id;
    EXPECT_TRUE(same_bits(position, b.landmarks.at(id))) << id;  // compares bits, because == takes -0 for 0
  }
}

StillMask make_mask(int64_t session, int64_t utime_us, int rows) {
  cv::Mat pixels(48, 64, CV_8U, cv::Scalar(255));
  pixels.rowRange(48 - rows, 48) = 0;
  return {.session = session,
          .utime_us = utime_us,
          .width = 64,
          .height = 48,
          .left_out = rows / 48.0,
          .png = rows == 0 ? "" : encode_mask(pixels)};
}

mask_t make_mask_message(int64_t stream, const StillMask& mask) {
  mask_t message{};
  message.utime = mask.utime_us;
  message.stream = stream;
  message.session = mask.session;
  message.width = mask.width;
  message.height = mask.height;
  message.left_out = mask.left_out;
  message.png.assign(mask.png.begin(), mask.png.end());
  message.size = static_cast<int32_t>(message.png.size());
  return message;
}

void expect_same(const Atlas& a, const Atlas& b) {
  EXPECT_EQ(a.revision(), b.revision());
  EXPECT_EQ(a.masks(), b.masks());
  EXPECT_EQ(a.links(), b.links());
  EXPECT_EQ(a.frames(), b.frames());
  ASSERT_EQ(a.submaps().size(), b.submaps().size());
  for (const auto& [key, x] : a.submaps()) {
    const AtlasSubmap* y = b.find(key);
    ASSERT_NE(y, nullptr);
    EXPECT_EQ(x.in_map, y->in_map);
    expect_same(x.placement, y->placement);
    expect_same(x.submap, y->submap);
  }
}

}  // namespace rumi::testing
