// SPDX-License-Identifier: BSD-3-Clause
// Tests the types of messages: their fingerprints, and that no message, however broken, harms the receiver.
#include <gtest/gtest.h>

#include <random>

#include "bus/transport/memory_bus.h"
#include "lcmtypes/rumi/chunk_ack_t.hpp"
#include "lcmtypes/rumi/chunk_t.hpp"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/map_pose_t.hpp"
#include "lcmtypes/rumi/map_region_t.hpp"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "lcmtypes/rumi/trajectory_t.hpp"
#include "lcmtypes/rumi/window_job_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"

namespace rumi {
namespace {

constexpr int kBrokenMessages = 10'000;  // broken messages of each type

// A change of a type changes the wire: old logs and running processes would not be understood any more.
TEST(WireTest, FingerprintsOfBotCore) {
  EXPECT_EQ(static_cast<uint64_t>(image_t::getHash()), 0x14739ffe13d5f5f0u);
  EXPECT_EQ(static_cast<uint64_t>(rigid_transform_t::getHash()), 0xea9ffbf2acc5c5aeu);
}

TEST(WireTest, FingerprintsOfOurs) {
#define PIN(type, value) EXPECT_EQ(static_cast<uint64_t>(type::getHash()), value) << #type
  PIN(image_metadata_t, 0x9a4b634d0577fb8eu);
  PIN(rigid_t, 0xecc586678117a361u);
  PIN(similarity_t, 0x921252151c85e6f1u);
  PIN(track_t, 0x62c27dd2abc30321u);
  PIN(keyframe_features_t, 0x16f7c72ec6c9f740u);
  PIN(keyframe_t, 0x267f4f227684cc17u);
  PIN(landmark_t, 0x4456b82dd7a35e00u);
  PIN(frame_t, 0xd5ada0b856872fd7u);
  PIN(submap_update_t, 0xf98d005885732696u);
  PIN(window_t, 0xe82f862f94b3f078u);
  PIN(window_sample_t, 0x2023c02d415c880fu);
  PIN(window_job_t, 0x6289e149b63ce14bu);
  PIN(submap_summary_t, 0xf0b51c44fdd54040u);
  PIN(link_t, 0x38f23425dfb0bba0u);
  PIN(trajectory_t, 0x9f9c1e97bfff7377u);
  PIN(region_landmark_t, 0x7727a9f260872891u);
  PIN(region_keyframe_t, 0x54927c4600a883b2u);
  PIN(map_region_t, 0xa84f598e98ae44ecu);
  PIN(map_status_t, 0x47bbe47c29d5c74du);
  PIN(map_pose_t, 0xa9c2f74d5fba016u);
  PIN(mask_t, 0xcb2512a5776ba018u);
  PIN(map_request_t, 0x5ec708767f84a2acu);
  PIN(chunk_t, 0xf81ada9fcebb4606u);
  PIN(chunk_ack_t, 0x4d310b1c244e70acu);
  PIN(channel_count_t, 0xc064025a9c303bc9u);
  PIN(process_status_t, 0xfe7d3c50228adaafu);
#undef PIN
}

template <class T>
T small() {
  return T{};  // all numbers 0, all strings and arrays empty
}

// Returns a message of the type with something in its strings and arrays.
template <class T>
T sample();

template <>
image_t sample() {
  image_t m = small<image_t>();
  m.width = 4, m.height = 2, m.row_stride = 4, m.pixelformat = image_t::PIXEL_FORMAT_GRAY;
  m.data.assign(8, 200);
  m.size = 8;
  m.metadata.push_back({"calibration", 3, {1, 2, 3}});
  m.metadata.push_back({"", 0, {}});
  m.nmetadata = 2;
  return m;
}
template <>
rigid_transform_t sample() {
  return small<rigid_transform_t>();
}
template <>
track_t sample() {
  return small<track_t>();
}
template <>
submap_update_t sample() {
  submap_update_t m = small<submap_update_t>();
  m.calibration = "fx: 1";
  m.features.push_back({1, 2, 2, {1, 2}, {3, 4}, {0, 1}, {0, 1}, 64, std::vector<uint8_t>(64, 9)});
  m.keyframes.push_back({1, 2, small<rigid_t>(), 2, {0, 1}, {7, 8}});
  m.removed_keyframes = {3, 4};
  m.landmarks.resize(3, small<landmark_t>());
  m.removed_landmarks = {5};
  m.frames.resize(2, small<frame_t>());
  m.nfeatures = 1, m.nkeyframes = 1, m.nremoved_keyframes = 2, m.nlandmarks = 3, m.nremoved_landmarks = 1;
  m.nframes = 2;
  return m;
}
template <>
window_t sample() {
  window_t m = small<window_t>();
  m.reason = "why";
  m.approach_utime = {1, 2}, m.gap_utime = {3}, m.departure_utime = {4, 5, 6};
  m.napproach = 2, m.ngap = 1, m.ndeparture = 3;
  return m;
}
template <>
window_job_t sample() {
  window_job_t m = small<window_job_t>();
  m.window = sample<window_t>();
  m.calibration = "fx: 1";
  m.samples.resize(6, small<window_sample_t>());
  m.nsamples = 6;
  return m;
}
template <>
map_status_t sample() {
  map_status_t m = small<map_status_t>();
  m.submaps.resize(2, small<submap_summary_t>());
  m.nsubmaps = 2;
  m.links.resize(2, small<link_t>());
  m.links[0].doubt = "why";
  m.nlinks = 2;
  return m;
}
template <>
trajectory_t sample() {
  trajectory_t m = small<trajectory_t>();
  m.frame_utime = {1, 2, 3};
  m.frame_stream = {4, 4, 5};
  m.map_from_cam.resize(3, small<rigid_t>());
  m.position_sigma = {1, 2, 3}, m.rotation_sigma_rad = {4, 5, 6}, m.log_scale_sigma = {7, 8, 9};
  m.n = 3;
  return m;
}
template <>
map_region_t sample() {
  map_region_t m = small<map_region_t>();
  m.landmarks.resize(3, small<region_landmark_t>());
  m.keyframes.resize(2, small<region_keyframe_t>());
  m.nlandmarks = 3, m.nkeyframes = 2;
  return m;
}
template <>
map_request_t sample() {
  map_request_t m = small<map_request_t>();
  m.requester = "viewer@host:1";
  return m;
}
template <>
chunk_t sample() {
  chunk_t m = small<chunk_t>();
  m.sender = "a", m.receiver = "b";
  m.data.assign(20, 1);
  m.size = 20;
  return m;
}
template <>
chunk_ack_t sample() {
  chunk_ack_t m = small<chunk_ack_t>();
  m.sender = "a", m.receiver = "b", m.reason = "c";
  m.missing = {1, 2, 3};
  m.nmissing = 3;
  return m;
}
template <>
process_status_t sample() {
  process_status_t m = small<process_status_t>();
  m.process = "p", m.host = "h", m.version = "0", m.detail = "d";
  m.channels.resize(2, small<channel_count_t>());
  m.nchannels = 2;
  return m;
}

// Returns the message truncated, lengthened, with random bytes, or with nothing but random bytes behind the right
// fingerprint.
std::vector<uint8_t> broken(const std::vector<uint8_t>& good, std::mt19937* random) {
  std::vector<uint8_t> bytes = good;
  const auto byte = [&] { return static_cast<uint8_t>((*random)()); };
  switch ((*random)() % 4) {
    case 0:
      bytes.resize((*random)() % good.size());
      break;
    case 1:
      for (size_t i = 0, n = 1 + (*random)() % 4; i < n; ++i) bytes[8 + (*random)() % (bytes.size() - 8)] = byte();
      break;
    case 2:
      bytes[(*random)() % bytes.size()] ^= static_cast<uint8_t>(1 << ((*random)() % 8));
      break;
    default:
      bytes.resize(8 + (*random)() % (2 * good.size()));
      for (size_t i = 8; i < bytes.size(); ++i) bytes[i] = byte();
  }
  return bytes;
}

template <class T>
class BrokenMessages : public testing::Test {};
using AllTypes =
    testing::Types<image_t, rigid_transform_t, track_t, submap_update_t, window_t, window_job_t, map_status_t,
                   map_request_t, trajectory_t, map_region_t, chunk_t, chunk_ack_t, process_status_t>;
TYPED_TEST_SUITE(BrokenMessages, AllTypes);

TYPED_TEST(BrokenMessages, AreCountedAndHarmNothing) {
  MemoryBus bus;
  int handled = 0;
  bus.subscribe<TypeParam>("X", {}, [&](const TypeParam& message) {
    ++handled;
    // An accepted message is whole: it can be encoded again.
    EXPECT_GT(encode_message(message).size(), 0u);
  });
  const std::vector<uint8_t> good = encode_message(sample<TypeParam>());
  bus.publish_raw("X", good);
  bus.dispatch();
  ASSERT_EQ(handled, 1);

  std::mt19937 random(42);
  for (int i = 0; i < kBrokenMessages; ++i) bus.publish_raw("X", broken(good, &random));
  EXPECT_EQ(bus.dispatch(), kBrokenMessages);
  const ChannelCounts counts = bus.counts().at(0);
  EXPECT_EQ(counts.received, kBrokenMessages + 1);
  EXPECT_EQ(counts.received, handled + counts.undecodable);
  EXPECT_GT(counts.undecodable, kBrokenMessages / 5);
}

TYPED_TEST(BrokenMessages, EveryTruncationIsRefused) {
  const std::vector<uint8_t> good = encode_message(sample<TypeParam>());
  TypeParam message;
  for (size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(Bus::decode(std::span(good).first(size), &message)) << size;
  std::vector<uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_FALSE(Bus::decode(longer, &message));
  EXPECT_TRUE(Bus::decode(good, &message));
  EXPECT_EQ(encode_message(message), good);
}

// A length that the message cannot hold must be refused before memory is asked for.
TEST(WireTest, HostileLengthsAllocateNothing) {
  chunk_t chunk = sample<chunk_t>();
  std::vector<uint8_t> bytes = encode_message(chunk);
  for (const uint32_t length : {21u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    for (int i = 0; i < 4; ++i) bytes[bytes.size() - 24 + i] = static_cast<uint8_t>(length >> (24 - 8 * i));
    chunk_t decoded;
    EXPECT_FALSE(Bus::decode(bytes, &decoded)) << length;
    EXPECT_EQ(decoded.data.capacity(), 0u) << length;
  }
}

TEST(WireTest, LengthsOfStructArraysAreBoundedByTheirSizeOnTheWire) {
  submap_update_t update = small<submap_update_t>();
  std::vector<uint8_t> bytes = encode_message(update);
  bytes.resize(bytes.size() + 1'000'000);  // enough for a million elements of 1 byte, but not of 60 or more
  const size_t nfeatures = 8 + 8 + 4 + 1 + 1 + 8 + 8 + 4 + 1;
  const uint32_t length = 900'000;
  for (int i = 0; i < 4; ++i) bytes[nfeatures + i] = static_cast<uint8_t>(length >> (24 - 8 * i));
  submap_update_t decoded;
  EXPECT_FALSE(Bus::decode(bytes, &decoded));
  EXPECT_EQ(decoded.features.capacity(), 0u);
}

}  // namespace
}  // namespace rumi
