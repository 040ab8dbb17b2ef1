// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/trajectory_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/files/whole_file.h"
#include "map_server/outputs/frames_by_session.h"

namespace rumi::map_server {
namespace {

// Writes q and -q (the same rotation) alike, and 0 and -0 too, so that equal trajectories give equal files.
std::string tum_line(int64_t utime_us, const SE3& pose) {
  Eigen::Vector4d q = pose.rotation.coeffs();  // x y z w
  if (q.w() < 0) q = -q;
  const auto text = [](double value) { return fmt::format(" {:.9f}", std::abs(value) < 5e-10 ? 0.0 : value); };
  std::string line = seconds_text(utime_us);
  for (int i = 0; i < 3; ++i) line += text(pose.translation[i]);
  for (int i = 0; i < 4; ++i) line += text(q[i]);
  return line + "\n";
}

}  // namespace

std::string seconds_text(int64_t utime_us) {
  const bool negative = utime_us < 0;
  const uint64_t us = negative ? 0 - static_cast<uint64_t>(utime_us) : static_cast<uint64_t>(utime_us);
  return fmt::format("{}{}.{:06}", negative ? "-" : "", us / 1'000'000, us % 1'000'000);
}

Result<> write_trajectory_tum(const Atlas& atlas, const std::string& file, int64_t after) {
  WholeFile out(file);
  const std::map<ImageId, SE3> trajectory = atlas.map_trajectory();
  for (const auto& [key, record] : frames_by_session(atlas, after))
    if (const auto pose = trajectory.find(key.second); pose != trajectory.end())
      out.write(tum_line(key.second.utime_us, pose->second));
  return out.commit();
}

Result<> write_submap_tum(const Submap& submap, const std::string& file) {
  WholeFile out(file);
  for (const auto& [utime_us, frame] : submap.frames)
    out.write(tum_line(utime_us, submap.cam_from_submap(frame).inverse()));
  return out.commit();
}

std::string submap_file_name(const Atlas& atlas, SubmapKey key) {
  const bool is_latest = key.session == atlas.submaps().rbegin()->first.session;
  const std::string session = is_latest ? "" : fmt::format("s{}-", key.session);
  return fmt::format("{}{}{:03}.txt", session, key.id < 0 ? "b" : "", std::abs(static_cast<int64_t>(key.id)));
}

}  // namespace rumi::map_server
