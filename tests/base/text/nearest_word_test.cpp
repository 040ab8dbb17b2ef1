// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/nearest_word.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

TEST(NearestWord, IsTheOneSpeltMostAlike) {
  EXPECT_EQ(nearest_word("evry", {"start", "every", "duration"}), "every");
  EXPECT_EQ(nearest_word("anything", {}), "");
}

TEST(SimilarWord, HasMostLettersInCommonOrBeginsAlike) {
  EXPECT_EQ(similar_word("relay", {"replay", "report", "up"}), "replay");
  EXPECT_EQ(similar_word("snap", {"snapshot", "synth"}), "snapshot");
  EXPECT_EQ(similar_word("gui", {"replay", "report", "up"}), "");
  EXPECT_EQ(similar_word("x", {}), "");
}

}  // namespace
}  // namespace rumi
