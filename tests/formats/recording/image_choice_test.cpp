// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/image_choice.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Names = std::vector<std::string>;

// Returns names with consecutive numbers; `form` has one {} for the number.
Names numbered(const std::string& form, int count, int first = 0) {
  Names names;
  for (int i = 0; i < count; ++i) names.push_back(fmt::format(fmt::runtime(form), first + i));
  return names;
}

Names together(const Names& a, const Names& b) {
  Names all = a;
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

Names kept(const Names& names, const std::string& pattern = "") {
  Names all;
  const Result<ImageChoice> choice = choose_images(names, pattern);
  for (const size_t i : choice->kept) all.push_back(names[i]);
  return all;
}

TEST(ImageChoice, ImagesOfOneCameraStayTogether) {
  for (const Names& names : {numbered("{:05}.png", 60), numbered("frame-{:06}.color.jpg", 60), numbered("{}.png", 12),
                             numbered("rgb/1305031102.{:06}.png", 60), Names{"a.png", "b.png", "c.png"},
                             Names{"a1.png", "b1.png", "c1.png", "d1.png"},
                             together(numbered("GOPR{:04}.jpg", 9), numbered("GP01{:04}.jpg", 9)),
                             together(numbered("part1_{:04}.jpg", 9), numbered("part2_{:04}.jpg", 9, 9)),
                             together(numbered("walk{:03}.jpg", 9), numbered("back{:03}.jpg", 9, 9))}) {
    EXPECT_EQ(kept(names), names) << names.front();
    EXPECT_EQ(choose_images(names, "").value().note, "") << names.front();
  }
  EXPECT_TRUE(choose_images({}, "").value().kept.empty());
}

TEST(ImageChoice, TwoKindsThatCountAlikeAreToldApart) {
  const std::pair<const char*, const char*> pairs[] = {{"frame-{:06}.color.jpg", "frame-{:06}.depth.png"},
                                                       {"{:05}.jpg", "{:05}.png"},
                                                       {"left{:04}.jpg", "right{:04}.jpg"},
                                                       {"{:04}_L.png", "{:04}_R.png"},
                                                       {"rgb_{:04}.png", "depth_{:04}.png"},
                                                       {"cam0_{:04}.png", "cam1_{:04}.png"},
                                                       {"image_2_{:06}.png", "image_3_{:06}.png"},
                                                       {"scan_{:03}.png", "scan_{:03}_mask.png"},
                                                       {"rgb/{:05}.png", "depth/{:05}.png"},
                                                       {"left/{:05}.png", "right/{:05}.png"},
                                                       {"1_{:05}.png", "2_{:05}.png"},
                                                       {"{:05}_0.png", "{:05}_1.png"},
                                                       {"Kamera1-{:05}.png", "Kamera2-{:05}.png"},
                                                       {"{:05}_cam0.png", "{:05}_cam1.png"},
                                                       {"{:05}.0.png", "{:05}.1.png"}};
  for (const auto& [camera, other] : pairs) {
    const Names wanted = numbered(camera, 60), others = numbered(other, 60);
    for (const Names& names : {together(wanted, others), together(others, wanted)}) {
      EXPECT_EQ(kept(names), wanted) << camera;
      EXPECT_THAT(choose_images(names, "").value().note, AllOf(HasSubstr("60 of"), HasSubstr("camera_driver.files")));
    }
  }
}

TEST(ImageChoice, DepthWithItsOwnTimesIsToldByItsName) {
  const Names colour = numbered("rgb/1305031102.{:06}.png", 60),
              depth = numbered("depth/1305031102.{:06}.png", 60, 400);
  EXPECT_EQ(kept(together(depth, colour)), colour);
}

TEST(ImageChoice, TwoCamerasWithTheirOwnTimesAreToldByTheirNames) {
  for (const auto& [camera, other] : {std::pair{"left-14000000{:05}.png", "right-14000000{:05}.png"},
                                      std::pair{"cam0-14000000{:05}.png", "cam1-14000000{:05}.png"},
                                      std::pair{"14000000{:05}_cam0.png", "14000000{:05}_cam1.png"}}) {
    const Names wanted = numbered(camera, 60), others = numbered(other, 60, 100);
    EXPECT_EQ(kept(together(wanted, others)), wanted) << camera;
  }
}

TEST(ImageChoice, SecondsAndCountersAreOfOneCamera) {
  Names names;
  for (int s = 10; s < 13; ++s)
    for (int i = 0; i < 30; ++i) names.push_back(fmt::format("16530{}_{:03}.png", s, i));
  EXPECT_EQ(kept(names), names);
}

TEST(ImageChoice, APictureWithoutANumberIsNoFrame) {
  Names names = numbered("{:05}.png", 20);
  names.push_back("cover.png");
  EXPECT_EQ(kept(names), numbered("{:05}.png", 20));
}

TEST(ImageChoice, AStarInANameIsALetter) {
  const Names stars = {"a*1b2.png", "a*1b3.png", "a*2b2.png"};
  EXPECT_EQ(kept(stars), stars);
  EXPECT_EQ(kept({"a*.png", "a1.png", "a2.png"}), (Names{"a1.png", "a2.png"}));
}

TEST(ImageChoice, APatternDecides) {
  const Names names = together(numbered("in/left{:04}.jpg", 6), numbered("in/right{:04}.jpg", 6));
  EXPECT_EQ(kept(names, "right*"), numbered("in/right{:04}.jpg", 6));
  EXPECT_EQ(kept(names, "in/*"), names);
  EXPECT_EQ(choose_images(names, "right*").value().note, "");
  EXPECT_THAT(choose_images(names, "middle*").error_text(), AllOf(HasSubstr("middle*"), HasSubstr("in/left0000.jpg")));
}

}  // namespace
}  // namespace rumi
