// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/submap_blob.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace rumi::tool {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

template <class T>
void append(T value, std::string* blob) {
  blob->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void append_floats(std::initializer_list<double> values, std::string* blob) {
  for (const double value : values) append(static_cast<float>(value), blob);
}

}  // namespace

std::string submap_blob(const viewer_offscreen::SubmapView& view) {
  std::array<uint32_t, 8> head{
      0, static_cast<uint32_t>(view.trajectory.size()), static_cast<uint32_t>(view.keyframe_poses.size()),
      static_cast<uint32_t>(view.landmarks.size()), static_cast<uint32_t>(view.covisible.size())};
  std::memcpy(head.data(), kSubmapBlobMark, sizeof(kSubmapBlobMark));
  std::string blob;
  blob.reserve(sizeof(head) + 20 * view.trajectory.size() + 28 * view.keyframe_poses.size() +
               12 * view.landmarks.size() + 8 * view.covisible.size());
  for (const uint32_t word : head) append(word, &blob);
  for (const auto& point : view.trajectory) append(1e-6 * static_cast<double>(point.utime_us), &blob);
  for (const auto& point : view.trajectory)
    append_floats({point.position.x(), point.position.y(), point.position.z()}, &blob);
  for (const auto& keyframe : view.keyframe_poses) {
    const auto& [turn, at] = keyframe.map_from_cam;
    append_floats({at.x(), at.y(), at.z(), turn.w(), turn.x(), turn.y(), turn.z()}, &blob);
  }
  for (const Eigen::Vector3f& landmark : view.landmarks)
    append_floats({landmark.x(), landmark.y(), landmark.z()}, &blob);
  for (const auto& [a, b] : view.covisible) {
    append(static_cast<uint32_t>(a), &blob);
    append(static_cast<uint32_t>(b), &blob);
  }
  return blob;
}

}  // namespace rumi::tool
