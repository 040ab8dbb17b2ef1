// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/proof_of_depth.h"

#include <gmock/gmock.h>

#include "tests/ruminator/rebuild/film.h"

namespace rumi::ruminator {
namespace {

using testing::Film;
using testing::film;
using ::testing::HasSubstr;

const std::atomic<bool> kNoCancel = false;

TEST(ProofOfDepth, AModelNeedsPairsThatShowDepth) {
  const Film turning = film(6, 0), moving = film(6, 0.1);
  EXPECT_THAT(prove_depth(turning.camera, turning.images, turning.pairs, {0, 1, 2, 3, 4, 5}, kNoCancel).error_text(),
              HasSubstr("0 show depth"));
  EXPECT_EQ(prove_depth(moving.camera, moving.images, moving.pairs, {0, 1, 2, 3, 4, 5}, kNoCancel).error_text(), "");
  EXPECT_NE(prove_depth(moving.camera, moving.images, moving.pairs, {0, 5}, kNoCancel).error_text(), "")
      << "two images are no model";
  EXPECT_NE(prove_depth(moving.camera, moving.images, {}, {0, 1, 2}, kNoCancel).error_text(), "");
  EXPECT_EQ(prove_depth(turning.camera, turning.images, turning.pairs, {0, 1, 2, 3}, true).error_text(), "")
      << "called off";
}

}  // namespace
}  // namespace rumi::ruminator
