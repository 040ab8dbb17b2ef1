// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_refinement.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/triangulation.h"
#include "slam/map/submap.h"
#include "slam/numeric/median.h"
#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/resection.h"

namespace rumi::ruminator {
namespace {

constexpr int kIterations = 20;  // most iterations of a bundle adjustment

using PointIndex = std::vector<std::vector<int>>;  // [image][keypoint]: point, or kNone

PointIndex index_points(const std::vector<WindowImage>& images, const SparseModel& model) {
  PointIndex index;
  for (const WindowImage& image : images) index.emplace_back(image.keypoints.size(), kNone);
  for (size_t p = 0; p < model.points.size(); ++p)
    for (const auto& [image, keypoint] : model.points[p].track) index[image][keypoint] = static_cast<int>(p);
  return index;
}

double error_px(const Camera& camera, const SE3& cam_from_world, const Eigen::Vector3d& point,
                const Eigen::Vector2f& pixel) {
  const Eigen::Vector3d in_camera = cam_from_world * point;
  if (in_camera.z() <= 0) return std::numeric_limits<double>::infinity();
  return (camera.project_undistorted(in_camera) - pixel.cast<double>()).norm();
}

// Returns the unit vectors from the point to the cameras that see it.
std::vector<Eigen::Vector3d> directions_to_cameras(const SparseModel& model, const SparseModel::Point& point) {
  std::vector<Eigen::Vector3d> directions;
  for (const auto& [image, keypoint] : point.track)
    directions.push_back((model.cam_from_world.at(image).center() - point.position).normalized());
  return directions;
}

struct WidestRays {
  double cosine = 1;  // cosine of the parallax, the angle between the two rays
  size_t first = 0, second = 0;
};

// Finds the two rays with the largest angle between them, ignoring the ray `left_out`.
WidestRays widest_rays(const std::vector<Eigen::Vector3d>& directions, size_t left_out = SIZE_MAX) {
  WidestRays widest;
  for (size_t i = 0; i < directions.size(); ++i) {
    for (size_t j = i + 1; j < directions.size() && i != left_out; ++j) {
      if (j == left_out) continue;
      if (const double cosine = directions[i].dot(directions[j]); cosine < widest.cosine) widest = {cosine, i, j};
    }
  }
  return widest;
}

void solve(const Camera& camera, const std::vector<WindowImage>& images, SparseModel* model) {
  BundleProblem problem;
  std::map<int, int> view_of;
  for (const auto& [image, pose] : model->cam_from_world) {
    view_of[image] = static_cast<int>(problem.views.size());
    problem.views.push_back({pose, problem.views.empty()});
  }
  for (const SparseModel::Point& point : model->points) {
    const int index = static_cast<int>(problem.points.size());
    problem.points.push_back(point.position);
    for (const auto& [image, keypoint] : point.track)
      problem.observations.push_back({view_of.at(image), index, images[image].keypoints[keypoint].cast<double>(), 1.0});
  }
  BundleOptions options;
  options.iterations = kIterations;
  if (!solve_bundle(camera, options, &problem).usable) return;
  for (const auto& [image, view] : view_of) model->cam_from_world[image] = problem.views[view].cam_from_submap;
  for (size_t p = 0; p < model->points.size(); ++p) model->points[p].position = problem.points[p];
}

bool resect_image(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs,
                  int image, const ModelRefinementOptions& options, SparseModel* model, PointIndex* index) {
  std::map<int, int> candidates;  // keypoint -> point, taken from the first pair that has one
  for (const ImagePair& pair : pairs) {
    if (pair.first != image && pair.second != image) continue;
    const int other = pair.first == image ? pair.second : pair.first;
    for (const auto& [a, b] : pair.matches) {
      const int own = pair.first == image ? a : b, theirs = pair.first == image ? b : a;
      if (const int point = (*index)[other][theirs]; point != kNone) candidates.try_emplace(own, point);
    }
  }
  std::vector<PointObservation> observations;
  observations.reserve(candidates.size());
  for (const auto& [keypoint, point] : candidates)
    observations.push_back({model->points[point].position, images[image].keypoints[keypoint].cast<double>(), 1.0});
  ResectionOptions resection;
  resection.min_inliers = options.resection_min_inliers;
  resection.max_error_px = options.max_error_px;
  const auto pose = resect(camera, observations, resection);
  if (!pose) return false;
  model->cam_from_world[image] = pose->cam_from_submap;
  size_t i = 0;
  for (const auto& [keypoint, point] : candidates) {
    if (!pose->inlier[i++]) continue;
    // An image observes a point only once.
    Track& track = model->points[point].track;
    if (std::any_of(track.begin(), track.end(), [image](const auto& o) { return o.first == image; })) continue;
    track.emplace_back(image, keypoint);
    (*index)[image][keypoint] = point;
  }
  return true;
}

// Triangulates those matches of the image with other images of the model that do not belong to a point yet.
void triangulate_matches(const Camera& camera, const std::vector<WindowImage>& images,
                         const std::vector<ImagePair>& pairs, int image, const ModelRefinementOptions& options,
                         SparseModel* model, PointIndex* index) {
  for (const ImagePair& pair : pairs) {
    if (pair.first != image && pair.second != image) continue;
    if (!model->cam_from_world.contains(pair.first) || !model->cam_from_world.contains(pair.second)) continue;
    const SE3 &pose_a = model->cam_from_world.at(pair.first), &pose_b = model->cam_from_world.at(pair.second);
    for (const auto& [a, b] : pair.matches) {
      int &point_a = (*index)[pair.first][a], &point_b = (*index)[pair.second][b];
      if (point_a != kNone || point_b != kNone) continue;
      const Eigen::Vector2f &pixel_a = images[pair.first].keypoints[a], &pixel_b = images[pair.second].keypoints[b];
      const auto position = triangulate(pose_a, camera.ray(pixel_a), pose_b, camera.ray(pixel_b));
      if (!position || error_px(camera, pose_a, *position, pixel_a) > options.max_error_px ||
          error_px(camera, pose_b, *position, pixel_b) > options.max_error_px ||
          parallax_rad(*position, pose_a.center(), pose_b.center()) < options.min_parallax_deg * M_PI / 180)
        continue;
      point_a = point_b = static_cast<int>(model->points.size());
      model->points.push_back({*position, {{pair.first, a}, {pair.second, b}}});
    }
  }
}

}  // namespace

bool has_parallax(const SparseModel& model, const SparseModel::Point& point, double min_parallax_deg) {
  return widest_rays(directions_to_cameras(model, point)).cosine <= std::cos(min_parallax_deg * M_PI / 180);
}

void remove_images(const std::set<int>& images, SparseModel* model) {
  for (int image : images) model->cam_from_world.erase(image);
  for (SparseModel::Point& point : model->points)
    std::erase_if(point.track, [&](const auto& o) { return images.contains(o.first); });
  std::erase_if(model->points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
}

void prune_model(const Camera& camera, const std::vector<WindowImage>& images, const ModelRefinementOptions& options,
                 SparseModel* model) {
  for (SparseModel::Point& point : model->points) {
    std::erase_if(point.track, [&](const auto& o) {
      return !(error_px(camera, model->cam_from_world.at(o.first), point.position,
                        images[o.first].keypoints[o.second]) <= options.max_error_px);
    });
  }
  std::erase_if(model->points, [&](const SparseModel::Point& point) {
    return point.track.size() < 2 || !has_parallax(*model, point, options.min_parallax_deg);
  });
  std::map<int, int> seen;
  for (const SparseModel::Point& point : model->points)
    for (const auto& [image, keypoint] : point.track) ++seen[image];
  // An image that sees fewer points than resection needs has no reliable pose.
  std::set<int> gone;
  for (const auto& [image, pose] : model->cam_from_world)
    if (seen[image] < options.resection_min_inliers) gone.insert(image);
  remove_images(gone, model);
}

ModelQuality model_quality(const Camera& camera, const std::vector<WindowImage>& images, const SparseModel& model) {
  ModelQuality q;
  double sum = 0;
  for (const SparseModel::Point& point : model.points) {
    for (const auto& [image, keypoint] : point.track) {
      const double e =
          error_px(camera, model.cam_from_world.at(image), point.position, images[image].keypoints[keypoint]);
      sum += e * e;
      ++q.observations;
    }
  }
  if (q.observations > 0) q.rmse_px = std::sqrt(sum / q.observations);
  return q;
}

ModelQuality adjust_model(const Camera& camera, const std::vector<WindowImage>& images,
                          const ModelRefinementOptions& options, SparseModel* model) {
  for (int round = 0; round < 2; ++round) {
    solve(camera, images, model);
    prune_model(camera, images, options, model);
  }
  return model_quality(camera, images, *model);
}

std::optional<SparseModel::Point> triangulate_track(const Camera& camera, const std::vector<WindowImage>& images,
                                                    const Track& track, const ModelRefinementOptions& options,
                                                    const SparseModel& model) {
  constexpr size_t kShort = 6;
  const auto pixel = [&images](const auto& o) { return images[o.first].keypoints[o.second]; };
  SparseModel::Point best;
  for (size_t i = 0; i < track.size(); ++i) {
    for (size_t j = i + 1; j < track.size(); ++j) {
      const auto is_pivot = [&track](size_t k) { return k == 0 || k == track.size() / 2 || k + 1 == track.size(); };
      if (track.size() > kShort && !(is_pivot(i) && is_pivot(j))) continue;
      const SE3 &pose_i = model.cam_from_world.at(track[i].first), &pose_j = model.cam_from_world.at(track[j].first);
      const auto position = triangulate(pose_i, camera.ray(pixel(track[i])), pose_j, camera.ray(pixel(track[j])));
      if (!position) continue;
      SparseModel::Point point{*position, {}};
      for (const auto& o : track)
        if (error_px(camera, model.cam_from_world.at(o.first), *position, pixel(o)) <= options.max_error_px)
          point.track.push_back(o);
      if (point.track.size() > best.track.size()) best = std::move(point);
    }
  }
  if (best.track.size() < 2 || !has_parallax(model, best, options.min_parallax_deg)) return std::nullopt;
  return best;
}

void triangulate_tracks(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<Track>& tracks,
                        const ModelRefinementOptions& options, SparseModel* model) {
  model->points.clear();
  for (const Track& track : tracks) {
    Track posed;
    for (const auto& o : track)
      if (model->cam_from_world.contains(o.first)) posed.push_back(o);
    if (auto point = triangulate_track(camera, images, posed, options, *model)) model->points.push_back(*point);
  }
}

namespace {

// Counts, for each image, the points in it that the other images alone can triangulate.
std::map<int, int> points_placed_by_others(const ModelRefinementOptions& options, const SparseModel& model) {
  const double max_cosine = std::cos(0.5 * options.min_parallax_deg * M_PI / 180);
  std::map<int, int> placed;
  for (const auto& [image, pose] : model.cam_from_world) placed[image] = 0;
  for (const SparseModel::Point& point : model.points) {
    const std::vector<Eigen::Vector3d> directions = directions_to_cameras(model, point);
    const WidestRays widest = widest_rays(directions);
    for (size_t i = 0; i < point.track.size(); ++i) {
      const bool is_outer = i == widest.first || i == widest.second;
      placed[point.track[i].first] += (is_outer ? widest_rays(directions, i) : widest).cosine <= max_cosine;
    }
  }
  return placed;
}

// Counts the points in these images that the other images alone can triangulate.
int points_shared(const std::set<int>& images, const ModelRefinementOptions& options, const SparseModel& model) {
  const double max_cosine = std::cos(0.5 * options.min_parallax_deg * M_PI / 180);
  int shared = 0;
  for (const SparseModel::Point& point : model.points) {
    SparseModel::Point others = point;
    std::erase_if(others.track, [&](const auto& o) { return images.contains(o.first); });
    if (others.track.size() == point.track.size() || others.track.size() < 2) continue;
    shared += widest_rays(directions_to_cameras(model, others)).cosine <= max_cosine;
  }
  return shared;
}

// Returns the images of the loose end at the beginning (or the end, if `last`) of the model; an empty set if that end
// holds.
std::set<int> loose_end(bool last, const std::set<int>& known, const ModelRefinementOptions& options,
                        const SparseModel& model) {
  std::vector<int> images;  // images in order, from that end on
  for (const auto& [image, pose] : model.cam_from_world) images.push_back(image);
  if (last) std::reverse(images.begin(), images.end());
  const auto is_known = [&](int image) { return known.contains(image); };
  if (std::find_if_not(images.begin(), images.end(), is_known) - images.begin() >= kHoldingImages) return {};
  std::set<int> end;
  for (size_t i = 0; i < images.size() && i < kMostLooseImages; ++i) {
    end.insert(images[i]);
    if (points_shared(end, options, model) < kOpenEndFactor * options.resection_min_inliers) return end;
  }
  return {};
}

}  // namespace

int remove_loose_images(const ModelRefinementOptions& options, SparseModel* model) {
  int removed = 0;
  while (true) {
    const std::map<int, int> placed = points_placed_by_others(options, *model);
    const auto loosest = std::min_element(placed.begin(), placed.end(),
                                          [](const auto& a, const auto& b) { return a.second < b.second; });
    if (loosest == placed.end() || loosest->second >= options.resection_min_inliers) return removed;
    remove_images({loosest->first}, model);
    ++removed;
  }
}

int trim_open_ends(const std::set<int>& known, const ModelRefinementOptions& options, SparseModel* model) {
  int removed = 0;
  while (!model->cam_from_world.empty()) {
    std::set<int> gone = loose_end(false, known, options, *model);
    gone.merge(loose_end(true, known, options, *model));
    if (gone.empty()) break;
    remove_images(gone, model);
    removed += static_cast<int>(gone.size());
  }
  return removed;
}

int remove_strays(SparseModel* model) {
  std::vector<double> distances;
  for (const SparseModel::Point& point : model->points)
    for (const auto& [image, keypoint] : point.track)
      distances.push_back((point.position - model->cam_from_world.at(image).center()).norm());
  if (distances.empty()) return 0;
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> positions;
    for (const auto& [image, pose] : model->cam_from_world) positions.push_back(pose.center()[axis]);
    middle[axis] = median(&positions);
  }
  const double farthest = kMaxStray * median(&distances);
  std::set<int> strays;
  for (const auto& [image, pose] : model->cam_from_world)
    if (!((pose.center() - middle).norm() <= farthest)) strays.insert(image);
  remove_images(strays, model);
  return static_cast<int>(strays.size());
}

int resect_missing_images(const Camera& camera, const std::vector<WindowImage>& images,
                          const std::vector<ImagePair>& pairs, const ModelRefinementOptions& options,
                          SparseModel* model, int limit) {
  PointIndex index = index_points(images, *model);
  int added = 0;
  for (bool more = true; more && added < limit;) {
    more = false;
    for (int image = 0; image < static_cast<int>(images.size()) && added < limit; ++image) {
      if (model->cam_from_world.contains(image)) continue;
      if (!resect_image(camera, images, pairs, image, options, model, &index)) continue;
      triangulate_matches(camera, images, pairs, image, options, model, &index);
      more = true;
      ++added;
    }
  }
  return added;
}

}  // namespace rumi::ruminator
