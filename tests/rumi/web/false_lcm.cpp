// SPDX-License-Identifier: BSD-3-Clause
// false_lcm SUBMAPS LANDMARKS KEYFRAMES [--grow]: imitates a system with a large map on LCM until it is killed, for
// scripts/web_load.py. It publishes images and tracking at 30 Hz; with --grow the last submap gets 30 landmarks each
// second.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "base/or_throw.h"
#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "tests/rumi/web/false_system.h"

namespace rumi::tool {
namespace {

constexpr int kKeypoints = 500, kSeen = 200, kFramesPerKeyframe = 10;
constexpr int64_t kFrameUs = 33'333;

// Lets each keyframe of the submap see some of its landmarks, in turn.
void observe(Submap* submap) {
  int next = 0;
  const int landmarks = static_cast<int>(submap->landmarks.size());
  for (auto& [id, keyframe] : submap->keyframes) {
    auto features = std::make_shared<Features>();
    for (int i = 0; i < kKeypoints; ++i) features->keypoints.push_back({{i % 30 * 20.F, i / 30 * 20.F}, 0, 0});
    features->descriptors.resize(kKeypoints);
    features->undistort(submap->camera);
    keyframe.features = features;
    keyframe.landmark_ids.assign(kKeypoints, kNone);
    for (int i = 0; i < kSeen; ++i) submap->add_observation((next + i) % landmarks, id, i);
    next += kSeen / 4;
  }
}

std::map<int, Submap> make_submaps(int n, int landmarks, int keyframes) {
  std::map<int, Submap> submaps;
  const double seconds = keyframes * kFramesPerKeyframe / 30.0;
  for (int id = 1; id <= n; ++id) {
    const auto path = [id](double t) -> Eigen::Vector3d {
      return viewer_offscreen::test_circle(t) + Eigen::Vector3d(0.3 * id, 0, 0);
    };
    submaps[id] = viewer_offscreen::make_test_submap(id, (id - 1) * seconds, id * seconds, path, landmarks);
    observe(&submaps[id]);
  }
  return submaps;
}

void play(int submaps, int landmarks, int keyframes, bool grows) {
  const std::unique_ptr<LcmBus> bus = or_throw(LcmBus::open(kDefaultLcmUrl, {}));
  FalseSystem system(*bus, make_submaps(submaps, landmarks, keyframes));
  const int frames = submaps * keyframes * kFramesPerKeyframe;
  int64_t next_us = bus->now_us();
  for (int i = 0;; ++i) {
    const int frame = i % frames;
    system.publish_track(frame, frame * submaps / frames + 1);
    system.publish_image({640, 480});
    if (i % 30 == 0) {
      for (int k = 0; k < 30 && grows; ++k) system.grow(submaps);
      system.publish_statuses();
      system.publish_map();
    }
    for (next_us += kFrameUs; bus->now_us() < next_us;) {
      bus->dispatch(2);
      system.tick();
    }
  }
}

}  // namespace
}  // namespace rumi::tool

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "false_lcm SUBMAPS LANDMARKS KEYFRAMES [--grow]\n");
    return 2;
  }
  rumi::tool::play(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]),
                   argc > 4 && std::strcmp(argv[4], "--grow") == 0);
  return 0;
}
