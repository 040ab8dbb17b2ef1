// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/snapshot_queue.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>

#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SnapshotQueueTest : public ::testing::Test {
 protected:
  map_request_t request(int32_t id) const {
    map_request_t request{};
    request.requester = "asker";
    request.request_id = id;
    return request;
  }

  MapStore store_ = MapStore::open(":memory:").value();
  Result<> saved_;
  bool has_room_ = true;
  std::vector<int32_t> answered_;
  std::string refused_;
  SnapshotQueue queue_{store_,
                       false,
                       {.save = [this] { return saved_; },
                        .has_room = [this] { return has_room_; },
                        .answer =
                            [this](const map_request_t& request, const Result<DatabaseBytes>& copy) {
                              answered_.push_back(request.request_id);
                              refused_ += copy.error_text();
                            }}};
};

TEST_F(SnapshotQueueTest, ARequestWaitsUntilAllIsMerged) {
  queue_.add(request(1));
  queue_.tick();
  EXPECT_THAT(answered_, IsEmpty());
  EXPECT_TRUE(queue_.contains(request(1)));
  queue_.note_all_is_merged();
  queue_.add(request(2));  // comes later, so it waits for the next merge
  EXPECT_TRUE(queue_.has_merged());
  queue_.tick();
  EXPECT_THAT(answered_, ElementsAre(1));
  EXPECT_EQ(refused_, "");
  EXPECT_FALSE(queue_.contains(request(1)));
  EXPECT_TRUE(queue_.contains(request(2)));
  EXPECT_EQ(queue_.size(), 1u);
  EXPECT_FALSE(queue_.is_copying());
}

TEST_F(SnapshotQueueTest, NoCopyBeginsWithoutRoom) {
  queue_.add(request(1));
  queue_.note_all_is_merged();
  has_room_ = false;
  queue_.tick();
  EXPECT_THAT(answered_, IsEmpty());
  has_room_ = true;
  queue_.tick();
  EXPECT_THAT(answered_, ElementsAre(1));
}

TEST_F(SnapshotQueueTest, WhatCannotBeSavedIsAnsweredWithTheReason) {
  saved_ = Error{"the disk is full"};
  queue_.add(request(1));
  queue_.add(request(2));
  queue_.note_all_is_merged();
  queue_.tick();
  EXPECT_THAT(answered_, ElementsAre(1, 2));
  EXPECT_EQ(refused_, "the disk is fullthe disk is full");
}

}  // namespace
}  // namespace rumi::map_server
