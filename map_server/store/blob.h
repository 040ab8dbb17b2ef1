// SPDX-License-Identifier: BSD-3-Clause
// Converts between numbers and the little-endian blobs of map.db.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi::map_server {

static_assert(std::endian::native == std::endian::little, "map.db is written as the numbers lie in memory");

template <class T, class Allocator>
std::span<const uint8_t> as_blob(const std::vector<T, Allocator>& values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)};
}

template <class T, size_t N>
std::span<const uint8_t> as_blob(const std::array<T, N>& values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), sizeof(values)};
}

// Returns the values in the blob. Throws std::runtime_error if its size is no multiple of the size of T.
template <class T>
std::vector<T> vector_from_blob(std::span<const uint8_t> blob) {
  if (blob.size() % sizeof(T) != 0) throw std::runtime_error("a blob has the wrong size");
  std::vector<T> values(blob.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), blob.data(), blob.size());
  return values;
}

template <class Array>
Array array_from_blob(std::span<const uint8_t> blob) {
  Array values;
  if (blob.size() != sizeof(values)) throw std::runtime_error("a blob has the wrong size");
  std::memcpy(values.data(), blob.data(), sizeof(values));
  return values;
}

using PoseNumbers = std::array<double, 7>;
using SimilarityNumbers = std::array<double, 8>;

inline PoseNumbers pose_numbers(const SE3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  return {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
}

// Sets the members one by one: the constructor would normalize the quaternion, and so change its last bits.
inline SE3 pose_from_numbers(const PoseNumbers& n) {
  SE3 pose;
  pose.rotation = Eigen::Quaterniond(n[0], n[1], n[2], n[3]);
  pose.translation = Eigen::Vector3d(n[4], n[5], n[6]);
  return pose;
}

inline SimilarityNumbers similarity_numbers(const Sim3& s) {
  const Eigen::Quaterniond& q = s.rotation;
  const Eigen::Vector3d& t = s.translation;
  return {s.scale, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
}

inline Sim3 similarity_from_numbers(const SimilarityNumbers& n) {
  Sim3 s;
  s.scale = n[0];
  s.rotation = Eigen::Quaterniond(n[1], n[2], n[3], n[4]);
  s.translation = Eigen::Vector3d(n[5], n[6], n[7]);
  return s;
}

}  // namespace rumi::map_server
