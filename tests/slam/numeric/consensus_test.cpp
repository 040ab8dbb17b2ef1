// SPDX-License-Identifier: BSD-3-Clause
#include "slam/numeric/consensus.h"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <Eigen/LU>

namespace rumi {
namespace {

// y = a x^2 + b x + c, which three points determine.
using Parabola = Eigen::Vector3d;

double at(const Parabola& p, double x) { return p[0] * x * x + p[1] * x + p[2]; }

struct Points {
  std::vector<Eigen::Vector2d> points;

  std::optional<Parabola> through(const std::array<int, 3>& sample) const {
    Eigen::Matrix3d a;
    Eigen::Vector3d y;
    for (int i = 0; i < 3; ++i) {
      const double x = points[sample[i]].x();
      a.row(i) << x * x, x, 1;
      y[i] = points[sample[i]].y();
    }
    return a.inverse() * y;
  }
  std::vector<int> near(const Parabola& p) const {
    std::vector<int> members;
    for (int i = 0; i < static_cast<int>(points.size()); ++i)
      if (std::abs(at(p, points[i].x()) - points[i].y()) < 0.05) members.push_back(i);
    return members;
  }
  auto consensus(const SamplingOptions& options) const {
    return find_consensus_of_three(
        points.size(), options, [this](const auto& sample) { return through(sample); },
        [this](const Parabola& p) { return near(p); });
  }
};

// Returns `right` points of a parabola with noise, then `wrong` random ones.
Points make_points(int right, int wrong) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> anywhere(-2, 2), noise(-0.01, 0.01);
  Points made;
  for (int i = 0; i < right + wrong; ++i) {
    const double x = -1 + 2.0 * i / (right + wrong);
    made.points.emplace_back(x, i < right ? at({1, -0.5, 0.2}, x) + noise(rng) : anywhere(rng));
  }
  return made;
}

TEST(Consensus, FindsTheModelAmongWrongElements) {
  const Points points = make_points(40, 60);
  const auto found = points.consensus({.samples = 500});
  ASSERT_TRUE(found);
  EXPECT_NEAR(at(found->model, -0.5), at({1, -0.5, 0.2}, -0.5), 0.05);
  EXPECT_GE(std::count_if(found->members.begin(), found->members.end(), [](int i) { return i < 40; }), 35);
}

TEST(Consensus, IsTheSameEveryTime) {
  const Points points = make_points(20, 60);
  EXPECT_EQ(points.consensus({.samples = 100})->members, points.consensus({.samples = 100})->members);
}

TEST(Consensus, EndsWhenARightSampleCanHardlyHaveBeenMissed) {
  const Points points = make_points(100, 0);
  int drawn = 0;
  const auto count = [&](double miss_probability) {
    drawn = 0;
    find_consensus_of_three(
        points.points.size(), {.samples = 1000, .miss_probability = miss_probability},
        [&](const auto& sample) { return ++drawn, points.through(sample); },
        [&](const Parabola& p) { return points.near(p); });
    return drawn;
  };
  EXPECT_LT(count(1e-4), 100);
  EXPECT_GT(count(0), 900);  // 1000 without the samples that draw an element twice
}

TEST(Consensus, NeedsSoManySamples) {
  EXPECT_EQ(samples_needed(0.5, 1e-4), 69);  // log(1e-4) / log(1 - 1/8)
  EXPECT_LE(samples_needed(1, 1e-4), 1);
  EXPECT_EQ(samples_needed(0, 1e-4), 1'000'000'000);
  EXPECT_EQ(samples_needed(1, 0), std::numeric_limits<int>::max());
}

TEST(Consensus, IsNoneOfTwoElementsOrWithoutAModel) {
  EXPECT_FALSE(make_points(2, 0).consensus({}));
  const auto nothing = [](const auto&) { return std::optional<int>(); };
  EXPECT_FALSE(find_consensus_of_three(10, {}, nothing, [](int) { return std::vector<int>{1}; }));
}

}  // namespace
}  // namespace rumi
