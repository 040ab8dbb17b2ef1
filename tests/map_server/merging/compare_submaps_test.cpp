// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/compare_submaps.h"

#include <gtest/gtest.h>

#include "map_server/links/may_share_images.h"
#include "tests/map_server/synthetic_chain.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

class CompareSubmapsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete chain_; }
  static Chain* chain_;
};
Chain* CompareSubmapsTest::chain_ = nullptr;

TEST_F(CompareSubmapsTest, WhereTheyAgreeEachCommonKeyframeIsAJoint) {
  const Submap &front = chain_->submap(Chain::kFront1), &back = chain_->submap(Chain::kBack1);
  ASSERT_TRUE(may_share_images(front, back));
  const ComparedPair pair = compare_submaps(front, back, {});
  EXPECT_EQ(pair.revision_a, front.revision);
  EXPECT_EQ(pair.revision_b, back.revision);
  ASSERT_TRUE(pair.edge);
  EXPECT_TRUE(pair.edge->link.accepted()) << pair.edge->link.doubt;
  EXPECT_EQ(pair.edge->joints.size(), static_cast<size_t>(pair.edge->link.keyframe_inliers));
  for (const KeyframeJoint& joint : pair.edge->joints)
    EXPECT_EQ(front.keyframe(joint.a.id)->utime_us, back.keyframe(joint.b.id)->utime_us);
  EXPECT_EQ(pair.edge->utime_a_us, pair.edge->utime_b_us) << "one image";
  EXPECT_GT(pair.edge->utime_a_us, back.frames.begin()->first);
  EXPECT_LT(pair.edge->utime_a_us, front.frames.rbegin()->first);
}

TEST_F(CompareSubmapsTest, WhereTheyDoNotAgreeThereIsADoubtAndNoJoint) {
  const ComparedPair pair = compare_submaps(chain_->spoiled(Chain::kFront1), chain_->submap(Chain::kBack1), {});
  ASSERT_TRUE(pair.edge);
  EXPECT_FALSE(pair.edge->link.accepted());
  EXPECT_TRUE(pair.edge->joints.empty());
}

TEST_F(CompareSubmapsTest, WithoutACommonImageThereIsNoEdge) {
  const Submap &front = chain_->submap(Chain::kFront1), &later = chain_->submap(Chain::kFront3);
  EXPECT_FALSE(may_share_images(front, later));
  const ComparedPair pair = compare_submaps(front, later, {});
  EXPECT_FALSE(pair.edge);
  EXPECT_EQ(pair.revision_a, front.revision);
}

}  // namespace
}  // namespace rumi::testing
