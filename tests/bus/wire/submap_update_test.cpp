// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/submap_update.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "bus/transport/bus.h"
#include "tests/bus/wire/submap_editor.h"

namespace rumi {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Returns everything of a submap that is sent, as bytes. Revisions of single elements are not compared: those of a copy
// may be later than the original's.
std::vector<uint8_t> contents(const Submap& submap) { return encode_message(make_submap_update(submap, 0)); }

void expect_consistent(const Submap& submap) {
  size_t from_keyframes = 0, from_landmarks = 0;
  for (const auto& [id, kf] : submap.keyframes) {
    ASSERT_EQ(kf.landmark_ids.size(), kf.features->keypoints.size());
    for (int landmark : kf.landmark_ids) from_keyframes += landmark != kNone;
  }
  for (const auto& [id, lm] : submap.landmarks) {
    int last = kNone;
    for (const Observation& o : lm.observations) {
      EXPECT_GT(o.keyframe_id, last);
      last = o.keyframe_id;
      ASSERT_NE(submap.keyframe(o.keyframe_id), nullptr);
      EXPECT_EQ(submap.keyframe(o.keyframe_id)->landmark_ids.at(o.keypoint_index), id);
      ++from_landmarks;
    }
  }
  EXPECT_EQ(from_keyframes, from_landmarks);
}

// Sends an update from one submap to the other, encoded and decoded. Returns why it was refused, or an empty string.
std::string send(const Submap& from, int64_t base_revision, Submap* to) {
  const std::vector<uint8_t> bytes = encode_message(make_submap_update(from, base_revision));
  submap_update_t update;
  EXPECT_EQ(update.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return apply_submap_update(update, to).error_text();
}

TEST(SubmapUpdateTest, FullUpdateMakesAnEqualCopy) {
  const Submap original = random_submap(1);
  Submap copy;
  ASSERT_EQ(send(original, 0, &copy), "");
  EXPECT_EQ(copy.key, original.key);
  EXPECT_EQ(copy.revision, original.revision);
  EXPECT_EQ(copy.camera.fx, original.camera.fx);
  EXPECT_EQ(copy.camera.k1, original.camera.k1);
  EXPECT_EQ(contents(copy), contents(original));
  expect_consistent(copy);
  const Keyframe& a = original.keyframes.begin()->second;
  EXPECT_EQ(copy.keyframe(a.id)->cam_from_submap.rotation.coeffs(), a.cam_from_submap.rotation.coeffs());
}

// The submap has forgotten what was removed since the copy was made: the copy gets everything, and so do copies of that
// copy.
TEST(SubmapUpdateTest, AnOldCopyIsReplaced) {
  SubmapEditor editor(5);
  for (int i = 0; i < 100; ++i) editor.edit();
  Submap copy, relayed;
  ASSERT_EQ(send(editor.submap, 0, &copy), "");
  ASSERT_EQ(send(copy, 0, &relayed), "");
  for (int i = 0; i < 300; ++i) editor.edit();
  EXPECT_EQ(make_submap_update(editor.submap, copy.revision).base_revision, copy.revision);
  editor.submap.removed_landmarks.forget(copy.revision + 1);
  EXPECT_EQ(make_submap_update(editor.submap, copy.revision).base_revision, 0);
  EXPECT_EQ(make_submap_update(editor.submap, copy.revision + 1).base_revision, copy.revision + 1);
  ASSERT_EQ(send(editor.submap, copy.revision, &copy), "");
  EXPECT_EQ(contents(copy), contents(editor.submap));
  expect_consistent(copy);
  EXPECT_EQ(make_submap_update(copy, relayed.revision).base_revision, 0) << "it was not told what went";
  ASSERT_EQ(send(copy, relayed.revision, &relayed), "");
  EXPECT_EQ(contents(relayed), contents(editor.submap));
  expect_consistent(relayed);
}

// All copies must be the same, however often they were updated, and even if one was copied from another.
TEST(SubmapUpdateTest, AnySequenceOfDeltasEqualsOneFullUpdate) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SubmapEditor editor(seed);
    std::mt19937 random(seed + 1000);
    Submap always, sometimes, overlapping, relayed;
    for (int i = 0; i < 150; ++i) {
      editor.edit();
      ASSERT_EQ(send(editor.submap, always.revision, &always), "");
      if (random() % 5 == 0) {
        ASSERT_EQ(send(editor.submap, sometimes.revision, &sometimes), "");
      }
      if (random() % 7 == 0) {
        const int64_t base = overlapping.revision - static_cast<int64_t>(random() % 20);
        ASSERT_EQ(send(editor.submap, std::max<int64_t>(0, base), &overlapping), "");
      }
      const Submap& source = random() % 2 ? sometimes : overlapping;
      if (random() % 6 == 0 && source.revision > relayed.revision) {
        ASSERT_EQ(send(source, relayed.revision, &relayed), "");
      }
    }
    editor.submap.closed = true;
    ++editor.submap.revision;
    for (Submap* copy : {&always, &sometimes, &overlapping, &relayed}) {
      ASSERT_EQ(send(editor.submap, copy->revision, copy), "");
      ASSERT_EQ(contents(*copy), contents(editor.submap)) << "seed " << seed;
      EXPECT_TRUE(copy->closed);
      expect_consistent(*copy);
    }
  }
}

TEST(SubmapUpdateTest, ADeltaCarriesOnlyWhatChanged) {
  Submap submap = random_submap(2);
  const int64_t base = submap.revision++;
  Keyframe& kf = submap.keyframes.begin()->second;
  kf.revision = submap.revision;
  const submap_update_t update = make_submap_update(submap, base);
  EXPECT_EQ(update.nfeatures, 0);
  EXPECT_EQ(update.nkeyframes, 1);
  EXPECT_EQ(update.nlandmarks + update.nframes + update.nremoved_keyframes + update.nremoved_landmarks, 0);
}

TEST(SubmapUpdateTest, WhatIsNotNewerChangesNothing) {
  SubmapEditor editor(3);
  for (int i = 0; i < 50; ++i) editor.edit();
  const Submap older = editor.submap;
  for (int i = 0; i < 50; ++i) editor.edit();
  Submap copy;
  ASSERT_EQ(send(editor.submap, 0, &copy), "");
  const std::vector<uint8_t> before = contents(copy);
  EXPECT_EQ(send(older, 0, &copy), "");
  EXPECT_EQ(send(editor.submap, 0, &copy), "");
  EXPECT_EQ(contents(copy), before);
}

TEST(SubmapUpdateTest, AnotherCameraOrPyramidIsOfAnotherSubmap) {
  SubmapEditor editor(4);
  for (int i = 0; i < 50; ++i) editor.edit();
  Submap copy;
  ASSERT_EQ(send(editor.submap, 0, &copy), "");
  EXPECT_EQ(copy.pyramid, editor.submap.pyramid);
  const int64_t known = copy.revision;
  editor.edit();
  const Submap good = editor.submap;
  editor.submap.pyramid = {8, 1.4};
  EXPECT_THAT(send(editor.submap, known, &copy), HasSubstr("scale_factor 1.4: the submap has 8, 1.2"));
  editor.submap = good;
  editor.submap.camera.fx += 1;
  EXPECT_THAT(send(editor.submap, known, &copy), HasSubstr("calibration is not that of the submap"));
  EXPECT_EQ(copy.revision, known);
  EXPECT_EQ(send(good, known, &copy), "");
}

TEST(SubmapUpdateTest, AGapIsRefused) {
  const Submap original = random_submap(4);
  Submap copy;
  EXPECT_THAT(send(original, 5, &copy), HasSubstr("base_revision 5 is beyond revision 0"));
}

TEST(SubmapUpdateTest, AnotherSubmapIsRefused) {
  Submap copy, other = random_submap(5, 300);
  ASSERT_EQ(send(random_submap(5), 0, &copy), "");
  other.key.id = 2;
  EXPECT_THAT(send(other, 0, &copy), HasSubstr("submap 2, not of session 1234567 submap 1"));
}

// Breaks one thing of a good update. The message must say which, and the submap must stay as it was.
struct Damage {
  const char* says;
  std::function<void(submap_update_t&)> apply;
};

std::vector<Damage> damages() {
  using U = submap_update_t&;
  return {
      {"kind 7", [](U u) { u.kind = 7; }},
      {"submap_id 0", [](U u) { u.submap_id = 0; }},
      {"submap_id 1: front submaps", [](U u) { u.kind = submap_update_t::BACK; }},
      {"revision", [](U u) { u.base_revision = -1; }},
      {"revision", [](U u) { u.base_revision = 2; }},
      {"calibration", [](U u) { u.calibration = ""; }},
      {"calibration", [](U u) { u.calibration = "fx: nan"; }},
      {"calibration", [](U u) { u.calibration = std::string("\0\xff{[", 4); }},
      {"count", [](U u) { ++u.nkeyframes; }},
      {"count", [](U u) { u.nframes = -1; }},
      {"twice", [](U u) { u.keyframes.push_back(u.keyframes[0]), ++u.nkeyframes; }},
      {"twice", [](U u) { u.features.push_back(u.features[0]), ++u.nfeatures; }},
      {"twice", [](U u) { u.landmarks.push_back(u.landmarks[0]), ++u.nlandmarks; }},
      {"twice", [](U u) { u.frames.push_back(u.frames[0]), ++u.nframes; }},
      {"twice", [](U u) { u.removed_landmarks.push_back(u.landmarks[0].id), ++u.nremoved_landmarks; }},
      {"twice", [](U u) { u.removed_keyframes.push_back(u.keyframes[0].id), ++u.nremoved_keyframes; }},
      {"negative", [](U u) { u.keyframes[0].id = -1; }},
      {"negative", [](U u) { u.landmarks[0].id = -5; }},
      {"at most", [](U u) { u.keyframes[0].id = kMaxKeyframeId + 1; }},
      {"at most", [](U u) { u.landmarks[0].id = IdMap<Landmark>::kMaxId + 1; }},
      {"no such keyframe", [](U u) { u.features[0].keyframe_id = 9999; }},
      {"its features are missing", [](U u) { u.features.erase(u.features.begin()), --u.nfeatures; }},
      {"same length", [](U u) { u.features[0].x.pop_back(); }},
      {"same length", [](U u) { u.features[0].descriptors.pop_back(), --u.features[0].descriptor_bytes; }},
      {"not finite", [](U u) { u.features[0].y[0] = static_cast<float>(kNan); }},
      {"keypoint 1 is of octave 8, there are 8", [](U u) { u.features[0].octave[1] = 8; }},
      {"keypoint 0 is of octave 255", [](U u) { u.features[0].octave[0] = 255; }},
      {"outside the image", [](U u) { u.features[0].x[2] = 3e30F; }},
      {"outside the image", [](U u) { u.features[0].y[2] = -2; }},
      {"levels 0", [](U u) { u.levels = 0; }},
      {"levels -3", [](U u) { u.levels = -3; }},
      {"scale_factor 1:", [](U u) { u.scale_factor = 1; }},
      {"scale_factor nan", [](U u) { u.scale_factor = kNan; }},
      {"utime", [](U u) { ++u.keyframes[0].utime; }},
      {"cam_from_submap", [](U u) { u.keyframes[0].cam_from_submap.trans[2] = kNan; }},
      {"cam_from_submap", [](U u) { u.keyframes[0].cam_from_submap.quat[0] += 0.01; }},
      {"cam_from_submap",
       [](U u) {
         for (double& q : u.keyframes[0].cam_from_submap.quat) q = 0;
       }},
      {"with keypoint -1", [](U u) { u.keyframes[0].keypoint_index[0] = -1; }},
      {"with keypoint 1000000", [](U u) { u.keyframes[0].keypoint_index[0] = 1000000; }},
      {"observes twice", [](U u) { u.keyframes[0].keypoint_index[1] = u.keyframes[0].keypoint_index[0]; }},
      {"which does not exist", [](U u) { u.keyframes[0].landmark_id[0] = 424242; }},
      {"twice", [](U u) { u.keyframes[0].landmark_id[1] = u.keyframes[0].landmark_id[0]; }},
      {"same length", [](U u) { u.keyframes[0].landmark_id.pop_back(); }},
      {"position is not finite", [](U u) { u.landmarks[0].position[1] = std::numeric_limits<double>::infinity(); }},
      {"hangs on keyframe 777", [](U u) { u.frames[0].reference_keyframe = 777; }},
      {"cam_from_keyframe", [](U u) { u.frames[0].cam_from_keyframe.quat[3] = kNan; }},
  };
}

// Returns a submap of one keyframe that observes two landmarks.
Submap tiny() {
  Submap s;
  s.key = {1, 1};
  s.camera = test_camera();
  s.revision = 1;
  auto features = std::make_shared<Features>();
  features->keypoints.resize(3, {Eigen::Vector2f(1, 2), 0, 0});
  features->descriptors.resize(3);
  s.keyframes[4] = {4, 100, SE3(), features, {kNone, kNone, kNone}, 1, 1};
  s.frames.set({100, 4, SE3(), 1});
  for (int id : {7, 8}) {
    Landmark& lm = s.landmarks[id];
    lm.id = id;
    lm.revision = 1;
  }
  EXPECT_TRUE(s.add_observation(7, 4, 0));
  EXPECT_TRUE(s.add_observation(8, 4, 2));
  return s;
}

TEST(SubmapUpdateTest, ADamagedUpdateIsRefusedAndChangesNothing) {
  const Submap source = tiny();
  for (const Damage& damage : damages()) {
    submap_update_t update = make_submap_update(source, 0);
    damage.apply(update);
    Submap copy;
    EXPECT_THAT(apply_submap_update(update, &copy).error_text(), HasSubstr(damage.says));
    EXPECT_EQ(copy.revision, 0);
    EXPECT_EQ(copy.key, SubmapKey{});
    EXPECT_TRUE(copy.keyframes.empty() && copy.landmarks.empty() && copy.frames.empty());
  }
}

TEST(SubmapUpdateTest, RemovalsMayNotLeaveReferences) {
  Submap copy = tiny();
  submap_update_t update = make_submap_update(tiny(), 1);
  update.base_revision = 1, update.revision = 2;
  update.removed_landmarks = {7};
  update.nremoved_landmarks = 1;
  EXPECT_THAT(apply_submap_update(update, &copy).error_text(),
              HasSubstr("removed landmark 7: keyframe 4 still observes it"));
  update.removed_landmarks.clear();
  update.nremoved_landmarks = 0;
  update.removed_keyframes = {4};
  update.nremoved_keyframes = 1;
  EXPECT_THAT(apply_submap_update(update, &copy).error_text(),
              HasSubstr("removed keyframe 4: frame 100 still hangs on it"));
  EXPECT_EQ(contents(copy), contents(tiny()));
}

TEST(SubmapUpdateTest, DeviationsTravelWithTheFrames) {
  Submap source = tiny(), copy;
  source.frames.set({100, 4, SE3(), 1, {0.1F, 0.003F, 0}});
  source.frames.set({200, 4, SE3(), 1});
  ASSERT_EQ(send(source, 0, &copy), "");
  EXPECT_EQ(copy.frames.at(100).sigmas, (PoseSigmas{0.1F, 0.003F, 0}));
  EXPECT_EQ(copy.frames.at(200).sigmas, PoseSigmas());
}

// Wrong deviations only say how certain a map is: it is not refused because of them.
TEST(SubmapUpdateTest, ADeviationThatIsNoneIsNotKnown) {
  const auto infinite = std::numeric_limits<float>::infinity();
  for (const float bad : {-1.0F, -0.01F, static_cast<float>(kNan), infinite, -infinite, 3e38F})
    for (float frame_t::*member : {&frame_t::position_sigma, &frame_t::rotation_sigma_rad, &frame_t::log_scale_sigma}) {
      Submap source = tiny(), copy;
      source.frames.set({100, 4, SE3(), 1, {0.1F, 0.003F, 0.2F}});
      submap_update_t update = make_submap_update(source, 0);
      update.frames[0].*member = bad;
      ASSERT_EQ(apply_submap_update(update, &copy).error_text(), "") << bad;
      EXPECT_EQ(copy.frames.at(100).sigmas, PoseSigmas()) << bad;
    }
  submap_update_t update = make_submap_update(tiny(), 0);
  update.frames[0].position_sigma = update.frames[0].rotation_sigma_rad = update.frames[0].log_scale_sigma = 0;
  Submap copy;
  ASSERT_EQ(apply_submap_update(update, &copy).error_text(), "");
  EXPECT_EQ(copy.frames.at(100).sigmas, PoseSigmas()) << "a sender that did not fill it in";
}

// A good update with some random bytes must be refused, or applied to a consistent submap, but never crash.
TEST(SubmapUpdateTest, RandomDamageLeavesAConsistentSubmap) {
  const std::vector<uint8_t> good = encode_message(make_submap_update(random_submap(6, 60), 0));
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    std::vector<uint8_t> bytes = good;
    for (int n = 0; n < 3; ++n) bytes[8 + random() % (bytes.size() - 8)] = static_cast<uint8_t>(random());
    submap_update_t update;
    if (update.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) continue;
    Submap copy;
    if (apply_submap_update(update, &copy)) expect_consistent(copy);
  }
}

}  // namespace
}  // namespace rumi
