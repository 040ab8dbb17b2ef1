// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/writers.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "base/files/whole_file.h"

namespace rumi::map_server {
namespace {

namespace fs = std::filesystem;

// q and -q are the same rotation, 0 and -0 the same number: one spelling each, so that equal trajectories are equal
// files.
std::string tum_line(int64_t utime_us, const SE3& pose) {
  Eigen::Vector4d q = pose.rotation.coeffs();  // x y z w
  if (q.w() < 0) q = -q;
  const auto text = [](double value) { return fmt::format(" {:.9f}", std::abs(value) < 5e-10 ? 0.0 : value); };
  std::string line = seconds_text(utime_us);
  for (int i = 0; i < 3; ++i) line += text(pose.translation[i]);
  for (int i = 0; i < 4; ++i) line += text(q[i]);
  return line + "\n";
}

std::string remove_stale_submaps(const fs::path& folder, const std::set<std::string>& ours) {
  static const std::regex name(R"((s-?\d+-)?b?\d{3,}\.txt)");
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename().string();
    if (ours.contains(file) || !std::regex_match(file, name)) continue;
    fs::remove(entry.path(), error);
    if (error) break;
  }
  return error ? fmt::format("cannot clear {}: {}", folder.string(), error.message()) : "";
}

// By session and time.
std::map<std::pair<int64_t, ImageId>, const FrameRecord*> frames_after(const Atlas& atlas, int64_t session) {
  std::map<std::pair<int64_t, ImageId>, const FrameRecord*> frames;
  for (const auto& [image, record] : atlas.frames())
    if (record.session > session) frames.emplace(std::pair(record.session, image), &record);
  return frames;
}

std::string write_submaps(const Atlas& atlas, const fs::path& folder, int64_t after) {
  std::set<std::string> written;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (key.session <= after) continue;
    const std::string name = submap_file_name(atlas, key);
    if (std::string problem = write_submap_tum(owner.submap, (folder / name).string()); !problem.empty())
      return problem;
    written.insert(name);
  }
  return remove_stale_submaps(folder, written);
}

}  // namespace

std::string seconds_text(int64_t utime_us) {
  const bool negative = utime_us < 0;
  const uint64_t us = negative ? 0 - static_cast<uint64_t>(utime_us) : static_cast<uint64_t>(utime_us);
  return fmt::format("{}{}.{:06}", negative ? "-" : "", us / 1'000'000, us % 1'000'000);
}

// Hues a golden angle apart: neighbours in number are far apart in colour, however many there are.
Colour submap_colour(SubmapKey key) {
  const double hue = std::fmod(0.58 + 0.61803398875 * std::abs(static_cast<double>(key.id)), 1.0);
  const double strength = key.id < 0 ? 0.6 : 1.0;
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue * 6.0, 6.0);
    const double saturation = 0.75;
    const double value = 1.0 - saturation * std::max(0.0, std::min({k, 4.0 - k, 1.0}));
    return static_cast<uint8_t>(std::lround(255 * strength * value));
  };
  return {channel(5), channel(3), channel(1)};
}

std::string write_trajectory_tum(const Atlas& atlas, const std::string& file, int64_t after) {
  WholeFile out(file);
  const std::map<ImageId, SE3> trajectory = atlas.map_trajectory();
  for (const auto& [key, record] : frames_after(atlas, after))
    if (const auto pose = trajectory.find(key.second); pose != trajectory.end())
      out.write(tum_line(key.second.utime_us, pose->second));
  return out.commit().error_text();
}

std::string write_submap_tum(const Submap& submap, const std::string& file) {
  WholeFile out(file);
  for (const auto& [utime_us, frame] : submap.frames)
    out.write(tum_line(utime_us, submap.cam_from_submap(frame).inverse()));
  return out.commit().error_text();
}

std::string submap_file_name(const Atlas& atlas, SubmapKey key) {
  const bool is_latest = key.session == atlas.submaps().rbegin()->first.session;
  const std::string session = is_latest ? "" : fmt::format("s{}-", key.session);
  return fmt::format("{}{}{:03}.txt", session, key.id < 0 ? "b" : "", std::abs(static_cast<int64_t>(key.id)));
}

std::string write_frames_csv(const Atlas& atlas, const std::string& file, int64_t after) {
  WholeFile out(file);
  out.write("utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session\n");
  for (const auto& [key, record] : frames_after(atlas, after)) {
    const ImageId image = key.second;
    const std::optional<LocatedFrame> located = atlas.locate(image);
    const PoseSigmas sigmas = located ? located->sigmas() : PoseSigmas();
    out.write(fmt::format(
        "{},{},{},{},{},{}\n", image.utime_us, to_string(record->state), located ? located->owner->submap.key.id : 0,
        located && located->owner->in_map ? 1 : 0,
        sigmas.are_known() ? fmt::format("{:.6g},{:.6g},{:.6g}", sigmas.position, sigmas.rotation_rad, sigmas.log_scale)
                           : ",,",
        record->session));
  }
  return out.commit().error_text();
}

Colour colour_of(const LandmarkRef& landmark, const LandmarkColours& colours) {
  const auto seen = colours.find(landmark);
  return seen == colours.end() ? submap_colour(landmark.submap) : seen->second;
}

std::string write_ply(const Atlas& atlas, const std::string& file, const LandmarkColours& colours) {
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
  return out.commit().error_text();
}

std::vector<std::string> write_outputs(const Atlas& atlas, const std::string& folder, int64_t after,
                                       const LandmarkColours& colours) {
  const fs::path root(folder);
  std::error_code error;
  fs::create_directories(root / "submaps", error);
  if (error) return {fmt::format("cannot create {}: {}", (root / "submaps").string(), error.message())};
  // On a disk that is nearly full: what is small and most wanted first.
  std::vector<std::string> problems = {write_trajectory_tum(atlas, (root / "trajectory.txt").string(), after),
                                       write_frames_csv(atlas, (root / "frames.csv").string(), after),
                                       write_submaps(atlas, root / "submaps", after),
                                       write_ply(atlas, (root / "map.ply").string(), colours)};
  std::erase(problems, "");
  return problems;
}

}  // namespace rumi::map_server
