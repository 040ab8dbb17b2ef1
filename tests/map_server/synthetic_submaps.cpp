// SPDX-License-Identifier: BSD-3-Clause
#include "tests/map_server/synthetic_submaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "slam/features/orb_extractor.h"
#include "slam/geometry/alignment.h"
#include "slam/map/landmark_view.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

class Dice {
 public:
  explicit Dice(unsigned seed) : rng_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(rng_); }
  Eigen::Vector3d normal3(double sigma) {
    const double x = normal(sigma), y = normal(sigma), z = normal(sigma);
    return {x, y, z};
  }
  Descriptor descriptor() {
    Descriptor d;
    for (uint64_t& word : d) word = rng_();
    return d;
  }
  uint64_t below(uint64_t n) { return rng_() % n; }
  std::mt19937_64& rng() { return rng_; }

 private:
  std::mt19937_64 rng_;
};

SE3 looking(const Eigen::Vector3d& center, double yaw_rad, double pitch_rad = 0) {
  return SE3(so3_exp({0, yaw_rad, 0}) * so3_exp({pitch_rad, 0, 0}), center).inverse();
}

Sim3 distortion_at(const Distortion& distortion, int image) {
  const auto after = distortion.upper_bound(image);
  return after == distortion.begin() ? Sim3() : std::prev(after)->second;
}

// Projects a world's points into images.
class Film {
 public:
  Film(const World& world, const FilmOptions& options)
      : world_(world), o_(options), dice_(options.seed), scales_(options.pyramid.scales()) {}

  Image image(int64_t utime_us, const SE3& cam_from_world) {
    Image image{utime_us, cam_from_world, {}, {}};
    for (size_t p = 0; p < world_.points.size(); ++p)
      if (static_cast<int>(image.point_of.size()) < o_.most_keypoints) see(static_cast<int>(p), &image);
    image.features.undistort(o_.camera);
    return image;
  }

 private:
  void see(int p, Image* image) {
    const Eigen::Vector3d in_cam = image->cam_from_world * world_.points[p];
    if (in_cam.z() < 0.3) return;
    const double octave = std::log(world_.octave0_distances[p] / in_cam.norm()) / std::log(scales_[1]);
    if (octave < -0.5 || octave > static_cast<double>(scales_.size()) - 0.5) return;
    const int nearest = std::clamp(static_cast<int>(std::lround(octave)), 0, static_cast<int>(scales_.size()) - 1);
    // The lens model maps rays far outside the field of view back into the image.
    if (std::abs(in_cam.x() / in_cam.z()) > 1.5 || std::abs(in_cam.y() / in_cam.z()) > 1.5) return;
    const auto pixel = o_.camera.project(in_cam);
    if (!pixel || !o_.camera.contains(*pixel, 5)) return;
    const double sigma_px = o_.noise_px * scales_[nearest];
    const double du = dice_.normal(sigma_px), dv = dice_.normal(sigma_px);
    Descriptor descriptor = world_.descriptors[p];
    for (int i = 0; i < o_.wrong_bits; ++i) {
      const uint64_t bit = dice_.below(256);
      descriptor[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    image->features.keypoints.push_back(
        {(*pixel + Eigen::Vector2d(du, dv)).cast<float>(), 0, static_cast<uint8_t>(nearest)});
    image->features.descriptors.push_back(descriptor);
    image->point_of.push_back(p);
  }

  const World& world_;
  const FilmOptions& o_;
  Dice dice_;
  std::vector<double> scales_;
};

class Maker {
 public:
  Maker(const World& world, const std::vector<Image>& images, const SubmapRecipe& recipe)
      : world_(world), images_(images), r_(recipe), dice_(recipe.seed) {
    made_.submap_from_world = recipe.submap_from_world;
    made_.submap.key = recipe.key;
    made_.submap.kind = recipe.kind;
    made_.submap.pyramid = recipe.pyramid;
    made_.submap.revision = 1;
  }

  SyntheticSubmap run(const Camera& camera) {
    made_.submap.camera = camera;
    for (int i = r_.first + r_.keyframe_offset; i <= r_.last; i += r_.keyframe_every) add_keyframe(i);
    if (r_.frames_between)
      for (int i = r_.first; i <= r_.last; ++i) add_frame(i);
    for (size_t p = 0; p < world_.points.size(); ++p) add_landmark(static_cast<int>(p));
    return std::move(made_);
  }

 private:
  Sim3 submap_from_true(int image) const { return r_.submap_from_world * distortion_at(r_.distortion, image); }

  SE3 noisy_pose(int image) {
    const SE3& truth = images_[image].cam_from_world;
    const SE3 world_from_cam = truth.inverse();
    const SE3 noisy(world_from_cam.rotation * so3_exp(dice_.normal3(r_.rotation_noise_deg * M_PI / 180)),
                    world_from_cam.translation + dice_.normal3(r_.center_noise_m));
    return submap_from_true(image).transform_camera(noisy.inverse());
  }

  void add_keyframe(int image) {
    const int id = static_cast<int>(image_of_.size());
    Keyframe& keyframe = made_.submap.keyframes[id];
    keyframe.id = id;
    keyframe.utime_us = images_[image].utime_us;
    keyframe.cam_from_submap = noisy_pose(image);
    // A copy, because features that came by a message are equal to another submap's, but not the same object.
    keyframe.features = std::make_shared<Features>(images_[image].features);
    keyframe.landmark_ids.assign(keyframe.features->size(), kNone);
    keyframe.revision = keyframe.created_revision = 1;
    made_.submap.frames.set({keyframe.utime_us, id, SE3(), 1});
    image_of_.push_back(image);
    for (size_t k = 0; k < images_[image].point_of.size(); ++k)
      seen_[images_[image].point_of[k]].push_back({id, static_cast<int>(k)});
  }

  void add_frame(int image) {
    const int64_t utime_us = images_[image].utime_us;
    if (made_.submap.frames.contains(utime_us)) return;
    const auto after = std::upper_bound(image_of_.begin(), image_of_.end(), image);
    const int reference = static_cast<int>(after == image_of_.begin() ? 0 : after - image_of_.begin() - 1);
    const SE3 cam_from_keyframe = noisy_pose(image) * made_.submap.keyframes.at(reference).cam_from_submap.inverse();
    made_.submap.frames.set({utime_us, reference, cam_from_keyframe, 1});
  }

  void add_landmark(int p) {
    const auto seen = seen_.find(p);
    if (seen == seen_.end() || seen->second.size() < 2 || dice_.uniform(0, 1) > r_.point_share) return;
    Landmark landmark;
    landmark.id = static_cast<int>(made_.point_of.size());
    landmark.position = landmark_position(p, seen->second[seen->second.size() / 2].keyframe_id);
    const int id = landmark.id;
    made_.submap.landmarks[id] = landmark;
    made_.point_of[id] = p;
    for (const Observation& o : seen->second) {
      int keypoint = o.keypoint_index;
      if (dice_.uniform(0, 1) < r_.wrong_observations)
        keypoint = static_cast<int>(dice_.below(made_.submap.keyframe(o.keyframe_id)->landmark_ids.size()));
      if (made_.submap.keyframe(o.keyframe_id)->landmark_ids[keypoint] == kNone)
        made_.submap.add_observation(id, o.keyframe_id, keypoint);
    }
    update_landmark_view(made_.submap, made_.submap.landmark(id));
  }

  // Displaces the landmark along the ray from one of the cameras that see it, like an error of triangulation.
  Eigen::Vector3d landmark_position(int p, int keyframe_id) {
    const int image = image_of_[keyframe_id];
    const SE3& cam_from_world = images_[image].cam_from_world;
    Eigen::Vector3d in_cam = cam_from_world * world_.points[p];
    if (dice_.uniform(0, 1) < r_.wrong_landmarks)
      in_cam *= std::exp(dice_.uniform(-1, 1));
    else
      in_cam *= std::max(0.1, 1 + dice_.normal(r_.depth_noise));
    return submap_from_true(image) * (cam_from_world.inverse() * in_cam);
  }

  const World& world_;
  const std::vector<Image>& images_;
  const SubmapRecipe& r_;
  Dice dice_;
  SyntheticSubmap made_;
  std::vector<int> image_of_;                     // the image of each keyframe
  std::map<int, std::vector<Observation>> seen_;  // the observations of each world point
};

}  // namespace

World make_room(unsigned seed, int points) {
  Dice dice(seed);
  World world;
  for (int i = 0; i < points; ++i) {
    const double u = dice.uniform(-3, 3), v = dice.uniform(-3, 3), h = dice.uniform(-1.5, 1.5);
    switch (dice.below(8)) {
      case 0:
        world.points.emplace_back(-3, h, u);
        break;
      case 1:
        world.points.emplace_back(3, h, u);
        break;
      case 2:
        world.points.emplace_back(u, h, -3);
        break;
      case 3:
        world.points.emplace_back(u, h, 3);
        break;
      case 4:
        world.points.emplace_back(u, i % 2 ? 1.5 : -1.5, v);
        break;
      default: {  // away from the camera's path
        const double angle = dice.uniform(-M_PI, M_PI), radius = dice.uniform(1.8, 3);
        world.points.emplace_back(radius * std::sin(angle), h, radius * std::cos(angle));
      }
    }
    world.descriptors.push_back(dice.descriptor());
    world.octave0_distances.push_back(dice.uniform(4, 8));
  }
  return world;
}

World make_tiles(unsigned seed, double period_m, int points_per_tile, int tiles) {
  Dice dice(seed);
  World world;
  std::vector<Eigen::Vector3d> tile;
  for (int i = 0; i < points_per_tile; ++i) {
    const double x = dice.uniform(0, period_m), y = dice.uniform(-1.2, 1.2), z = dice.uniform(2, 3);
    tile.emplace_back(x, y, z);
  }
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < points_per_tile; ++i) descriptors.push_back(dice.descriptor());
  for (int t = 0; t < tiles; ++t)
    for (int i = 0; i < points_per_tile; ++i) {
      world.points.push_back(tile[i] + Eigen::Vector3d((t - tiles / 2) * period_m, 0, 0));
      world.descriptors.push_back(descriptors[i]);
      world.octave0_distances.push_back(5);
    }
  return world;
}

CameraPath walk_round(int images, double turns) {
  CameraPath path;
  for (int i = 0; i < images; ++i) {
    const double angle = turns * 2 * M_PI * i / images;
    const Eigen::Vector3d center(1.2 * std::sin(angle), 0.1 * std::sin(3 * angle), 1.2 * std::cos(angle));
    path.push_back(looking(center, angle + 0.6, 0.1 * std::sin(2 * angle)));
  }
  return path;
}

CameraPath straight(int images, const Eigen::Vector3d& step, double yaw_per_image_rad) {
  CameraPath path;
  for (int i = 0; i < images; ++i) path.push_back(looking(i * step, i * yaw_per_image_rad));
  return path;
}

std::vector<Image> film(const World& world, const CameraPath& path, const FilmOptions& options) {
  Film camera(world, options);
  std::vector<Image> images;
  for (size_t i = 0; i < path.size(); ++i) {
    const int64_t utime_us = options.first_utime_us + static_cast<int64_t>(i) * options.period_us;
    const bool has_features = i % static_cast<size_t>(options.every) == 0;
    images.push_back(has_features ? camera.image(utime_us, path[i]) : Image{utime_us, path[i], {}, {}});
  }
  return images;
}

Distortion drift(const std::vector<Image>& images, int from, double log_scale_per_image, double yaw_per_image_rad) {
  Distortion distortion;
  Sim3 moved;
  for (int i = from; i < static_cast<int>(images.size()); ++i) {
    // About the camera, so that the path has no step.
    const Eigen::Vector3d center = moved * images[i].cam_from_world.center();
    const double scale = std::exp(log_scale_per_image);
    const Eigen::Quaterniond turn = so3_exp({0, yaw_per_image_rad, 0});
    moved = Sim3(scale, turn, center - scale * (turn * center)) * moved;
    distortion[i] = moved;
  }
  return distortion;
}

Distortion jump(int from, const Sim3& moved_from_true) { return {{from, moved_from_true}}; }

SyntheticSubmap make_submap(const World& world, const std::vector<Image>& images, const SubmapRecipe& recipe,
                            const Camera& camera) {
  return Maker(world, images, recipe).run(camera);
}

Sim3 random_gauge(unsigned seed) {
  Dice dice(seed);
  const Eigen::Vector3d axis = dice.normal3(1).normalized();
  const Eigen::Quaterniond rotation = so3_exp(dice.uniform(-M_PI, M_PI) * axis);
  const Eigen::Vector3d translation(dice.uniform(-10, 10), dice.uniform(-10, 10), dice.uniform(-10, 10));
  return {std::exp(dice.uniform(std::log(0.2), std::log(5.0))), rotation, translation};
}

Placement rigid_placement(const Submap& submap, const Sim3& map_from_submap) {
  Placement placement;
  for (const auto& [id, keyframe] : submap.keyframes) placement.map_from_submap[keyframe.utime_us] = map_from_submap;
  return placement;
}

PlacedSubmap truly_placed(const SyntheticSubmap& made) {
  return {&made.submap, rigid_placement(made.submap, made.submap_from_world.inverse())};
}

std::string inconsistency(const MapModel& model) {
  std::set<LandmarkRef> landmarks;
  for (size_t p = 0; p < model.points.size(); ++p) {
    const MapModel::Point& point = model.points[p];
    const std::string name = "point " + std::to_string(p);
    if (!point.position.allFinite()) return name + " is not finite";
    if (point.landmarks.empty() && !point.observations.empty()) return name + " is seen but is no landmark";
    for (const LandmarkRef& ref : point.landmarks)
      if (!landmarks.insert(ref).second) return name + ": a landmark that is another point too";
    std::set<int> views;
    for (const MapModel::Observation& o : point.observations) {
      if (!views.insert(o.view).second) return name + " is seen twice in view " + std::to_string(o.view);
      if (model.views[o.view].points[o.keypoint] != static_cast<int>(p)) return name + ": a view does not know of it";
    }
  }
  size_t there = 0, here = 0;
  for (const MapModel::View& view : model.views) {
    if (!view.cam_from_map.is_finite()) return "a view is not finite";
    for (int point : view.points) there += point != kNone;
  }
  for (const MapModel::Point& point : model.points) here += point.observations.size();
  return there == here ? "" : "a view knows of an observation that its point does not";
}

PathError path_error(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& truth) {
  const double kInfinity = std::numeric_limits<double>::infinity();
  const std::optional<Sim3> truth_from_estimate = umeyama(estimate, truth);
  if (!truth_from_estimate) return {kInfinity, kInfinity};
  PathError error;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double distance = (*truth_from_estimate * estimate[i] - truth[i]).norm();
    error.rmse += distance * distance / static_cast<double>(truth.size());
    error.worst = std::max(error.worst, distance);
  }
  error.rmse = std::sqrt(error.rmse);
  return error;
}

Sim3Error error_of(const Sim3& estimate, const Sim3& truth, const Eigen::Vector3d& at, double unit) {
  return {estimate.rotation.angularDistance(truth.rotation) * 180 / M_PI, std::log(estimate.scale / truth.scale),
          (estimate * at - truth * at).norm() / unit};
}

}  // namespace rumi::testing
