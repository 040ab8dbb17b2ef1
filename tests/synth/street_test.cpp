// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/features2d.hpp>

#include "synth/campus_walk.h"
#include "synth/handheld.h"
#include "synth/sequence_renderer.h"
#include "synth/street_plan.h"
#include "tests/support/temporary_folder.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kFree_m = 2.5;  // nothing that stands still is nearer to the path
constexpr double kRound_s = 24;  // of the figure of eight

// A figure of eight on a slope, 10 m/s, z up: it crosses itself, and comes back to where it began.
CameraPath figure_of_eight(double rounds) {
  CameraPath path;
  const auto at = [](double t) {
    const double a = 2 * M_PI * t / kRound_s;
    return Vector3d(55 * std::sin(a), 28 * std::sin(2 * a), 1.5 + 2 * std::sin(a));
  };
  for (double t = 0; t <= rounds * kRound_s + 1e-9; t += 0.1) {
    const Vector3d to = at(t + 0.01) - at(t - 0.01);
    path.add(100 + t, look(at(t), std::atan2(to.y(), to.x()), 0, 0));
  }
  return path;
}

std::string write(const testing::TemporaryFolder& folder, const CameraPath& path) {
  std::string text;
  for (const double t : path.times_s()) {
    const SE3 p = path.at(t);
    const Eigen::Quaterniond& q = p.rotation;
    char line[300];
    std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", t, p.translation.x(),
                  p.translation.y(), p.translation.z(), q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  return folder.write("path.txt", text);
}

struct Town {
  explicit Town(const CameraPath& path, const StreetStyle& style)
      : route(path, street_from_map(path)), field(route), plan(plan_street(route, style, 3, &field)) {}

  double from_path_m(const Vector2d& at) const {
    double least = 1e9;
    for (const Vector3d& p : route.points()) least = std::min(least, (p.head<2>() - at).norm());
    return least;
  }
  double from_path_m(const Footprint& f) const {
    double least = 1e9;
    for (double a = 0; a <= 1; a += 0.05)
      for (double i = 0; i <= 1; i += 0.05) least = std::min(least, from_path_m(f.at(a * f.width_m, i * f.depth_m)));
    return least;
  }

  Route route;
  StreetField field;
  StreetPlan plan;
};

void expect_free_path(const Town& town) {
  for (const House& house : town.plan.houses) {
    if (house.remote && town.field.distance_m(house.footprint.corner) > 40) continue;
    EXPECT_GT(town.from_path_m(house.footprint), kFree_m);
  }
  for (const Strip& strip : town.plan.strips) {
    for (const Vector2d& at : {strip.from, strip.to}) EXPECT_GT(town.from_path_m(at), kFree_m + 0.25);
  }
  for (const auto* places : {&town.plan.trees, &town.plan.lamps, &town.plan.signs}) {
    for (const Place& place : *places) EXPECT_GT(town.from_path_m(place.at), kFree_m + 0.2);
  }
  for (const Place& car : town.plan.parking) {
    const Vector2d t(std::cos(car.yaw_rad), std::sin(car.yaw_rad)), left(-t.y(), t.x());
    EXPECT_GT(town.from_path_m(Footprint{car.at - 2.3 * t - 0.93 * left, t, left, 4.6, 1.86}), kFree_m);
  }
}

bool inside(const Footprint& f, const Vector2d& at) {
  const double a = (at - f.corner).dot(f.along), i = (at - f.corner).dot(f.inward);
  return a > 0.6 && i > 0.6 && a < f.width_m - 0.6 && i < f.depth_m - 0.6;
}

TEST(StreetPlan, NothingStandsInTheWayOfATown) {
  const Town town(figure_of_eight(2), kTown);
  expect_free_path(town);
  const auto near =
      std::count_if(town.plan.houses.begin(), town.plan.houses.end(), [](const House& h) { return !h.remote; });
  EXPECT_GT(near, 20);
  EXPECT_GT(town.plan.parking.size(), 20u);
  EXPECT_GT(town.plan.trees.size(), 20u);
}

TEST(StreetPlan, NothingStandsInTheWayOfACampus) {
  const Town town(walk_campus(745, 3), kCampus);
  expect_free_path(town);
  EXPECT_GT(town.plan.houses.size(), 30u);
}

TEST(StreetPlan, HousesDoNotOverlap) {
  const Town town(figure_of_eight(1), kTown);
  for (const House& a : town.plan.houses)
    for (const House& b : town.plan.houses) {
      if (a.number == b.number || a.remote || b.remote) continue;
      for (double u = 0; u <= 1; u += 0.1)
        for (double v = 0; v <= 1; v += 0.1)
          EXPECT_FALSE(inside(a.footprint, b.footprint.at(u * b.footprint.width_m, v * b.footprint.depth_m)));
    }
}

TEST(StreetField, TheGroundFollowsThePath) {
  const CameraPath path = figure_of_eight(1);
  const Town town(path, kTown);
  for (const Vector3d& p : town.route.points()) {
    const Vector2d at = p.head<2>();
    if (at.norm() < 15) continue;  // where it crosses itself, the ground is between both heights
    EXPECT_NEAR(town.field.ground_m(at), p.z() - StreetField::kCameraHeight_m, 0.4);
  }
  EXPECT_NEAR(town.field.distance_m(Vector2d(town.route.at(30))), 0, 0.6);
  EXPECT_NEAR(town.field.distance_m(town.route.beside(30, 5)), 5, 0.3);
}

TEST(CampusWalk, TurnsAsARobotDoesAndCrossesItself) {
  const CameraPath path = walk_campus(745, 1);
  const std::vector<double>& times = path.times_s();
  ASSERT_NEAR(times.back() - times.front(), 745, 0.1);
  std::vector<Vector2d> metres;
  for (size_t i = 10; i < times.size(); i += 10) {
    const SE3 a = path.at(times[i - 10]), b = path.at(times[i]);
    const double dt = times[i] - times[i - 10];
    ASSERT_LT((a.inverse() * b).angle_rad() / dt, 60 * M_PI / 180);
    ASSERT_LT((b.translation - a.translation).norm() / dt, 1.6);
    metres.push_back(b.translation.head<2>());
  }
  int crossings = 0;
  const auto turn = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  for (size_t i = 0; i + 1 < metres.size(); ++i)
    for (size_t k = i + 40; k + 1 < metres.size(); ++k) {
      const Vector2d &a = metres[i], &b = metres[i + 1], &c = metres[k], &d = metres[k + 1];
      if (turn(a, b, c) * turn(a, b, d) >= 0 || turn(c, d, a) * turn(c, d, b) >= 0) continue;
      if (std::abs((b - a).normalized().dot((d - c).normalized())) < 0.5) ++crossings;
    }
  EXPECT_GE(crossings, 5);
}

SynthOptions small_street(const std::string& file) {
  SynthOptions options;
  options.scene = SceneKind::kStreet;
  options.path_file = file;
  options.seed = 5;
  options.camera = default_synth_camera(160, 120);
  options.grey = true;
  options.noise = 0;
  return options;
}

bool equal(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0; }

TEST(StreetSequence, APartInAnyOrderEqualsTheWhole) {
  const testing::TemporaryFolder folder;
  SynthOptions options = small_street(write(folder, figure_of_eight(2)));
  options.vehicle = VehicleKind::kRobot;
  std::vector<cv::Mat> whole;
  std::vector<SE3> truth;
  {
    SequenceRenderer renderer(options);
    for (int i = 40; i < 44; ++i) {
      whole.push_back(renderer.render(i));
      truth.push_back(renderer.map_from_cam(i));
    }
  }
  options.start_s = 4;
  options.duration_s = 0.35;
  SequenceRenderer part(options);
  ASSERT_EQ(part.frames(), 4);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(whole[0], corners, 15);
  EXPECT_GT(corners.size(), 60u);
  for (const int i : {3, 0, 2, 1}) {
    EXPECT_LT((part.map_from_cam(i).inverse() * truth[static_cast<size_t>(i)]).log().norm(), 1e-9);
    EXPECT_TRUE(equal(part.render(i), whole[static_cast<size_t>(i)])) << i;
  }
}

TEST(StreetSequence, BothPassesSeeTheSamePlaceAndALorryHidesIt) {
  const testing::TemporaryFolder folder;
  SynthOptions options = small_street(write(folder, figure_of_eight(2)));
  options.traffic = 0;
  options.exposure_s = 0;
  options.exposure_swing = 0;
  options.hard = {{HardPassage::Kind::kLorry, 30, 4}};
  SequenceRenderer renderer(options);
  const int round = static_cast<int>(std::lround(kRound_s * 10));
  ASSERT_LT((renderer.map_from_cam(50).inverse() * renderer.map_from_cam(50 + round)).log().norm(), 1e-6);
  EXPECT_LT(cv::norm(renderer.render(50), renderer.render(50 + round), cv::NORM_L1) / (160 * 120), 0.05);
  // In the middle of its passage the lorry covers most of the image, though not before and after.
  const auto changed = [&](int frame) {
    const cv::Mat difference = cv::abs(renderer.render(frame) - renderer.render(frame - round)) +
                               cv::abs(renderer.render(frame - round) - renderer.render(frame));
    return cv::countNonZero(difference > 3) / (160.0 * 120);
  };
  EXPECT_LT(changed(295), 0.02);
  EXPECT_GT(changed(322), 0.6);
}

std::string refusal(SynthOptions options) {
  try {
    SequenceRenderer renderer(options);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(StreetOptions, AreRefusedWithTheReason) {
  EXPECT_THAT(parse_scene_kind("forest").error().text(), HasSubstr("--scene forest: must be room or street"));
  EXPECT_THAT(parse_vehicle_kind("boat").error().text(), HasSubstr("--vehicle boat: must be car or robot"));
  EXPECT_THAT(parse_walk_kind("town").error().text(), HasSubstr("campus"));
  SynthOptions options;
  options.walk = WalkKind::kCampus;
  EXPECT_THAT(refusal(options), HasSubstr("--walk campus: is a walk of --scene street only"));
  options.scene = SceneKind::kStreet;
  options.seconds = 5;
  EXPECT_THAT(refusal(options), HasSubstr("seconds of the walk campus is 5"));
  options.walk = WalkKind::kDoors;
  EXPECT_THAT(refusal(options), HasSubstr("--scene street: needs a path"));
  options = {};
  options.vehicle = VehicleKind::kCar;
  EXPECT_THAT(refusal(options), HasSubstr("--vehicle"));
  options = {};
  options.hard = {{HardPassage::Kind::kLorry, 1, 2}};
  EXPECT_THAT(refusal(options), HasSubstr("--hard lorry"));
  const testing::TemporaryFolder folder;
  options = small_street(folder.write("short.txt", "1 0 0 0 0 0 0 1\n2 0 0 2 0 0 0 1\n"));
  EXPECT_THAT(refusal(options), HasSubstr("a street needs 10 m"));
  options = small_street(folder.write("far.txt", "1 0 0 0 0 0 0 1\n2 0 0 90000 0 0 0 1\n3 90000 0 0 0 0 0 1\n"));
  EXPECT_THAT(refusal(options), HasSubstr("square kilometres"));
}

}  // namespace
}  // namespace rumi::synth
