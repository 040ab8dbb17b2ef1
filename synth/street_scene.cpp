// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_scene.h"

#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "base/or_throw.h"
#include "synth/robot_shake.h"
#include "synth/street_rasterizer.h"
#include "synth/street_traffic.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kCarCamera_m = 1.65, kRobotCamera_m = 0.5;  // above the road
// The automatic exposure looks at the image in such steps, and follows it with this time constant.
constexpr double kLookEvery_s = 0.5, kLag_s = 0.9;
constexpr int kLooksBack = 6;
constexpr double kWantedGrey = 100, kMinGain = 0.7, kMaxGain = 2.3;
constexpr double kFixedGain = 1.3;

// The sky as a dome around the camera.
Triangles build_sky(const TextureAtlas::Patch& patch, const StreetDay& day, const StreetLight& light) {
  constexpr int kAround = 32, kUp = 8;
  constexpr double kRadius_m = 100;
  const cv::Vec3b hills(104, 126, 124);
  const double overcast = std::max(0.0, day.clouds - 0.5);
  const Palette colours{
      {cv::saturate_cast<uchar>(74 + 150 * overcast), cv::saturate_cast<uchar>(118 + 120 * overcast), 190},
      {250, 250, 252},
      hills};
  Triangles sky;
  const auto corner = [&](int i, int j) {
    const double azimuth = 2 * M_PI * i / kAround, up = kSkyBottom_rad + (kSkyTop_rad - kSkyBottom_rad) * j / kUp;
    return Corner{
        kRadius_m * Vector3d(std::cos(azimuth) * std::cos(up), std::sin(azimuth) * std::cos(up), std::sin(up)),
        double(i) / kAround, 1 - double(j) / kUp};
  };
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kUp; ++j)
      add_face({{corner(i + 1, j + 1), corner(i, j + 1), corner(i, j), corner(i + 1, j)}, {patch, colours}}, {},
               nullptr, light, Shadow::kNone, &sky);
  for (Vertex& vertex : sky.vertices) {
    vertex.light = 1.2f;
    vertex.dark[3] = 0;
  }
  return sky;
}

}  // namespace

struct StreetScene::Impl {
  Impl(const SynthOptions& o, const CameraPath& path, const Camera& pinhole)
      : options(o),
        street_from_map(synth::street_from_map(path)),
        route(path, street_from_map),
        style(o.path_file.empty() ? kCampus : kTown),
        half_view(pinhole.width / (2 * pinhole.fx)) {
    or_throw(StreetField::check(route));
    field = std::make_unique<StreetField>(route);
    put_on_wheels(path);
    plan = plan_street(route, style, o.seed, field.get());
    build(pinhole);
  }

  // Gives the camera its height above the road.
  void put_on_wheels(const CameraPath& path) {
    const bool robot = options.robot();
    const double height = robot ? kRobotCamera_m : kCarCamera_m;
    const SE3 map_from_street = street_from_map.inverse();
    for (const double t : path.times_s()) {
      SE3 pose = path.at(t);
      Vector3d at = street_from_map * pose.translation;
      at.z() = field->ground_m(at.head<2>()) + height;
      pose.translation = map_from_street * at;
      carried.add(t, pose);
    }
    if (robot) shake = std::make_unique<RobotShake>(options.seed);
  }

  void build(const Camera& pinhole) {
    // T
    const StreetDay day = make_day(options.seed, options.day);
    light = std::make_unique<StreetLight>(day, *field, plan);
    TextureAtlas atlas;
    models = std::make_unique<StreetModels>(options.seed, &atlas);
    site = std::make_unique<StreetSite>(StreetSite{*field, style, plan, *light, *models, options.seed, options.day});
    StreetMeshBuilder mesh(*light);
    build_ground(*site, &mesh);
    build_marks(*site, &mesh);
    build_houses(*site, &atlas, &mesh);
    build_things(*site, &mesh);
    cv::RNG rng = rng_of(options.seed, kSkyChance, static_cast<uint64_t>(options.day));
    const TextureAtlas::Patch sky = atlas.add(paint_sky(day.clouds, rng));
    traffic = std::make_unique<StreetTraffic>(*site, route, options.traffic, carried.times_s().front());
    StreetPicture picture{.mesh = mesh.finish(),
                          .sky = build_sky(sky, day, *light),
                          .layers = atlas.take_layers(),
                          .shadows = light->map(),
                          .shadows_low = field->low(),
                          .shadows_cell_m = light->map_cell_m()};
    rasterizer = std::make_unique<StreetRasterizer>(std::move(picture), pinhole);
  }

  // Returns how fast the camera goes over the ground.
  double speed_mps(double t) const {
    constexpr double kOver_s = 0.4;
    return (carried.at(t + kOver_s / 2).translation - carried.at(t - kOver_s / 2).translation).norm() / kOver_s;
  }

  Triangles moving(double t, const SE3& street_from_cam, double lorry) const {
    Triangles out;
    traffic->add(t, street_from_cam.translation.head<2>(), &out);
    if (lorry >= 0 && lorry <= 1) traffic->add_lorry(lorry, street_from_cam, half_view, &out);
    return out;
  }

  // Returns the brightness of the image at a moment of the grid of kLookEvery_s.
  double looked(int64_t k) {
    const auto known = brightness.find(k);
    if (known != brightness.end()) return known->second;
    const double t = static_cast<double>(k) * kLookEvery_s;
    const SE3 street_from_cam = street_from_map * carried.at(t);
    const double grey = rasterizer->brightness(street_from_cam.inverse(), moving(t, street_from_cam, -1));
    return brightness[k] = grey;
  }

  // Returns the gain that the exposure has reached at a moment of the grid.
  double settled_gain(int64_t k) {
    double sum = 0, weights = 0;
    for (int back = 0; back < kLooksBack; ++back) {
      const double weight = std::exp(-back * kLookEvery_s / kLag_s);
      sum += weight * looked(k - back);
      weights += weight;
    }
    return std::clamp(kWantedGrey * weights / std::max(1.0, sum), kMinGain, kMaxGain);
  }

  SynthOptions options;
  SE3 street_from_map;
  Route route;
  StreetStyle style;
  double half_view;
  CameraPath carried;
  std::unique_ptr<RobotShake> shake;
  std::unique_ptr<StreetField> field;
  StreetPlan plan;
  std::unique_ptr<StreetLight> light;
  std::unique_ptr<StreetModels> models;
  std::unique_ptr<StreetSite> site;
  std::unique_ptr<StreetTraffic> traffic;
  std::unique_ptr<StreetRasterizer> rasterizer;
  std::map<int64_t, double> brightness;
};

StreetScene::StreetScene(const SynthOptions& options, const CameraPath& path, const Camera& pinhole)
    : impl_(std::make_unique<Impl>(options, path, pinhole)) {}
StreetScene::~StreetScene() = default;

const CameraPath& StreetScene::camera_path() const { return impl_->carried; }

SE3 StreetScene::shaken(const SE3& map_from_cam, double time_s) const {
  return impl_->shake ? map_from_cam * impl_->shake->at(time_s, impl_->speed_mps(time_s)) : map_from_cam;
}

void StreetScene::draw(const Moment& moment, cv::Mat* rgba) {
  const SE3 street_from_cam = impl_->street_from_map * moment.map_from_cam;
  impl_->rasterizer->draw(street_from_cam.inverse(), impl_->moving(moment.time_s, street_from_cam, moment.lorry),
                          moment.blankness, rgba);
}

double StreetScene::gain(double time_s) {
  if (impl_->options.exposure_swing <= 0) return kFixedGain;
  const double step = time_s / kLookEvery_s;
  const int64_t k = static_cast<int64_t>(std::floor(step));
  const double u = step - static_cast<double>(k);
  return (1 - u) * impl_->settled_gain(k - 1) + u * impl_->settled_gain(k);
}

}  // namespace rumi::synth
