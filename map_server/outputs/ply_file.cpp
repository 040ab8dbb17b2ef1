// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/ply_file.h"

#include <fmt/format.h>

#include <map>

#include "base/files/whole_file.h"

namespace rumi::map_server {

Result<> write_ply(const Atlas& atlas, const std::string& file, const LandmarkColours& colours) {
  const std::map<ImageId, SE3> trajectory = atlas.map_trajectory();
  std::string body;
  size_t vertices = 0;
  const auto add = [&](const Eigen::Vector3d& p, Colour colour) {
    const Eigen::Vector3f xyz = p.cast<float>();
    body.append(reinterpret_cast<const char*>(xyz.data()), 12);
    body.append({static_cast<char>(colour.red), static_cast<char>(colour.green), static_cast<char>(colour.blue)});
    ++vertices;
  };
  for (const auto& [key, owner] : atlas.submaps()) {
    if (!owner.in_map) continue;
    for (const auto& [id, landmark] : owner.submap.landmarks)
      if (atlas.stands_for_itself(owner, id))
        add(owner.placement.position_in_map(owner.submap, landmark), colour_of({key, id}, colours));
  }
  const size_t landmarks = vertices;
  for (const auto& [image, map_from_cam] : trajectory) add(map_from_cam.translation, {255, 255, 255});

  WholeFile out(file);
  out.write(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment {} landmarks, then {} camera centres\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                  "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
                  landmarks, vertices - landmarks, vertices));
  out.write(body);
  return out.commit();
}

}  // namespace rumi::map_server
