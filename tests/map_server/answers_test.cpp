// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/answers.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using testing::make_submap;
using testing::update_atlas;

class AnswersTest : public ::testing::Test {
 protected:
  AnswersTest() { update_atlas(&atlas_, make_submap({7, 1}, 1, 3)); }
  map_request_t request(int8_t what, int32_t id, int32_t submap = 1) const {
    map_request_t request{};
    request.requester = "asker";
    request.request_id = id;
    request.what = what;
    request.session = 7;
    request.submap_id = submap;
    return request;
  }

  MemoryBus bus_;
  Atlas atlas_;
  Answers answers_{bus_, atlas_};
};

TEST_F(AnswersTest, AnAnswerIsUnderWayUntilItHasArrived) {
  const map_request_t asked = request(map_request_t::SUBMAP, 1);
  EXPECT_TRUE(answers_.is_idle());
  answers_.answer(asked);
  EXPECT_TRUE(answers_.is_under_way(asked));
  EXPECT_EQ(answers_.large(), 1);
  EXPECT_EQ(answers_.refused(), 0);
  EXPECT_FALSE(answers_.is_idle());
}

TEST_F(AnswersTest, RefusalsDoNotCountAsLarge) {
  answers_.answer(request(map_request_t::SUBMAP, 1, 99));
  answers_.answer(request(77, 2));
  EXPECT_EQ(answers_.refused(), 2);
  EXPECT_EQ(answers_.large(), 0);
}

TEST_F(AnswersTest, OneTooManyIsRefused) {
  for (int id = 1; id <= Answers::kMost; ++id) answers_.answer(request(map_request_t::SUBMAP, id));
  EXPECT_EQ(answers_.refused(), 0);
  answers_.answer(request(map_request_t::TRAJECTORY, 9));
  EXPECT_EQ(answers_.refused(), 1);
  EXPECT_EQ(answers_.large(), Answers::kMost);
}

TEST_F(AnswersTest, RefusalsThatNobodyTakesComeToAnEnd) {
  for (int id = 0; id < 200; ++id) answers_.answer(request(77, id));
  EXPECT_EQ(answers_.refused(), 200);
  EXPECT_FALSE(answers_.is_under_way(request(77, 199)));
}

}  // namespace
}  // namespace rumi::map_server
