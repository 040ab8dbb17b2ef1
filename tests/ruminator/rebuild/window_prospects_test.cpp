// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_prospects.h"

#include <gmock/gmock.h>

#include "tests/ruminator/rebuild/film.h"

namespace rumi::ruminator {
namespace {

using testing::Film;
using testing::film;
using ::testing::HasSubstr;

// A window of six images: two of the approach, two of the gap, two of the departure.
class Prospects : public ::testing::Test {
 protected:
  Prospects() {
    for (int i = 0; i < 6; ++i) {
      auto* const part = i < 2 ? &job_.window.approach : i < 4 ? &job_.window.gap : &job_.window.departure;
      part->push_back({.utime_us = utime(i)});
    }
  }
  static int64_t utime(int image) { return 1000 + image; }
  static UsableImages images_of(const Film& film) {
    UsableImages images;
    images.features = film.images;
    for (size_t i = 0; i < film.images.size(); ++i) images.utimes_us.push_back(utime(static_cast<int>(i)));
    return images;
  }
  std::string of_matches(const Film& film) const {
    return WindowProspects(job_, film.camera, options_, cancel_).of_matches(images_of(film), film.pairs).error_text();
  }

  WindowJob job_;
  BuildOptions options_;
  std::atomic<bool> cancel_ = false;
};

TEST_F(Prospects, AMovingCameraWhoseImagesMatchIsRebuilt) { EXPECT_EQ(of_matches(film(6, 0.1)), ""); }

TEST_F(Prospects, ACameraThatTurnsHasNoParallax) {
  EXPECT_THAT(of_matches(film(6, 0)), HasSubstr("no parallax between 6 images"));
}

TEST_F(Prospects, ImagesWithoutMatchesHaveTooLittleInCommon) {
  Film apart = film(6, 0.1);
  apart.pairs.clear();
  EXPECT_THAT(of_matches(apart), HasSubstr("of 6 images no three have enough in common"));
}

TEST_F(Prospects, TheGapMustMatchTheImagesAroundIt) {
  Film apart = film(6, 0.6);
  const auto is_in_gap = [](int image) { return image == 2 || image == 3; };
  std::erase_if(apart.pairs, [&](const ImagePair& p) { return is_in_gap(p.first) != is_in_gap(p.second); });
  std::erase_if(apart.pairs, [](const ImagePair& p) { return p.first < 2 && p.second > 3; });
  apart.pairs.push_back({0, 6, apart.pairs.front().matches});  // becomes a third image of the approach
  apart.images.push_back(apart.images.front());
  job_.window.approach.push_back({.utime_us = utime(6)});
  EXPECT_THAT(of_matches(apart), HasSubstr("none of the 2 images of the gap has enough in common"));
}

TEST_F(Prospects, AModelNeedsDepthInItsOwnImages) {
  const Film moving = film(6, 0.1);
  const WindowProspects prospects(job_, moving.camera, options_, cancel_);
  SparseModel model;
  for (int i = 0; i < 6; ++i) model.cam_from_world[i] = SE3();
  EXPECT_TRUE(prospects.of_model(images_of(moving), moving.pairs, model));
  while (model.cam_from_world.size() > 2) model.cam_from_world.erase(model.cam_from_world.begin());
  EXPECT_FALSE(prospects.of_model(images_of(moving), moving.pairs, model)) << "two images are no model";
}

TEST(UsefulModel, IsWhatPlacesTheGapOrBridgesIt) {
  EXPECT_TRUE(is_useful(0, 1, 0));
  EXPECT_TRUE(is_useful(3, 0, 3));
  EXPECT_FALSE(is_useful(10, 0, 2));
  EXPECT_FALSE(is_useful(0, 0, 0));
}

}  // namespace
}  // namespace rumi::ruminator
