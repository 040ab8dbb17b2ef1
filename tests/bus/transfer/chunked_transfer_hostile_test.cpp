// SPDX-License-Identifier: BSD-3-Clause
// Sends chunks and answers that are broken, or that come from an attacker.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bus/transfer/transfer_fixture.h"

namespace rumi {
namespace {

using testing::HasSubstr;
using HostileTransferTest = TransferTest;

chunk_t chunk(int32_t index, int32_t count, int64_t total, int size) {
  chunk_t c{};
  c.sender = "hostile";
  c.receiver = "server";
  c.transfer_id = 1;
  c.index = index;
  c.count = count;
  c.total_size = total;
  c.data.assign(size, 1);
  c.size = size;
  return c;
}

TEST_F(HostileTransferTest, ImplausibleHeadersAreIgnored) {
  for (const chunk_t& c : {
           chunk(-1, 3, 3000, 1000),                   // index
           chunk(3, 3, 3000, 1000),                    //
           chunk(0, 0, 0, 0),                          // count
           chunk(0, -5, 3000, 1000),                   //
           chunk(0, 1, -1, 0),                         // total
           chunk(0, 1, int64_t{1} << 62, 1000),        //
           chunk(0, 1 << 30, int64_t{1} << 40, 1024),  // more bytes than are allowed
           chunk(0, 1, 3000, 1000),                    // sizes that do not add up
           chunk(0, 3, 1000, 1000),                    //
           chunk(0, 3, 2000, 1000),                    //
           chunk(1, 3, 3001, 1000),                    //
           chunk(2, 3, 2501, 500),                     //
           chunk(0, 2, 10, 0),                         //
           chunk(0, 3, 2997, 999),                     // chunks that are too small
           chunk(2, 3, 1990, 10),                      //
       }) {
    bus_.publish("DATA", c);
    bus_.dispatch();
    bus_.set_now_us(bus_.now_us() + 1'000'000);
    receiver_->tick(bus_.now_us());
  }
  EXPECT_TRUE(received_.empty());
  EXPECT_EQ(bus_.published(), 15);  // nobody was answered
}

TEST_F(HostileTransferTest, AnnouncedSizesCostNoMemory) {
  // Each transfer announces 4 GB, for which no memory may be reserved.
  const int32_t count = 71'000;
  for (int id = 0; id < 200; ++id) {
    chunk_t c = chunk(count - 2, count, int64_t{60'000} * count, 60'000);
    c.transfer_id = id;
    bus_.publish("DATA", c);
  }
  bus_.dispatch();
  EXPECT_TRUE(received_.empty());
  EXPECT_FALSE(receiver_->progress(77).has_value());
}

TEST_F(HostileTransferTest, WhatCameInPartIsBoundedTheOldestGoes) {
  receiver_.reset();
  bus_.subscribe<chunk_t>("BOUNDED", {}, [](const chunk_t&) {});
  ChunkReceiver bounded(bus_, "BOUNDED", "ACK", "server", true,
                        [](const ChunkReceiver::Payload&) { return ChunkReceiver::Verdict{}; },
                        {.max_held_bytes = 100'000});
  const auto send = [&](int id, int index) {
    chunk_t c = chunk(index, 3, 90'000, 30'000);
    c.transfer_id = c.request_id = id;
    bus_.publish("BOUNDED", c);
    bus_.dispatch();
    bus_.set_now_us(bus_.now_us() + 1000);
  };
  send(1, 0);
  send(2, 0);
  send(1, 1);
  EXPECT_EQ(bounded.dropped(), 0);
  send(2, 1);
  EXPECT_EQ(bounded.dropped(), 1) << "120000 bytes are more than may be held";
  EXPECT_FALSE(bounded.progress(1).has_value()) << "it was silent for longest";
  EXPECT_EQ(bounded.progress(2), std::pair(2, 3));
  chunk_t too_large = chunk(0, 5, 150'000, 30'000);
  too_large.request_id = 3;
  bus_.publish("BOUNDED", too_large);
  bus_.dispatch();
  EXPECT_FALSE(bounded.progress(3).has_value()) << "it could never be whole";
}

TEST_F(HostileTransferTest, AHeaderThatChangesStartsAnew) {
  chunk_t a = chunk(0, 2, 2000, 1000), b = chunk(1, 2, 1999, 999);
  a.checksum = 1, b.checksum = 2;
  bus_.publish("DATA", a);
  bus_.publish("DATA", b);
  bus_.dispatch();
  EXPECT_TRUE(received_.empty());
  EXPECT_EQ(receiver_->progress(0), std::pair(1, 2));
}

TEST_F(HostileTransferTest, ADamagedChunkIsAskedForAgain) {
  bool damaged = false;
  bus_.set_tap([&](const std::string& channel, std::span<const uint8_t> data) {
    if (channel != "DATA" || damaged) return true;
    damaged = true;
    std::vector<uint8_t> bytes(data.begin(), data.end());
    bytes.back() ^= 1;
    bus_.publish_raw(channel, bytes);
    return false;
  });
  sender_.send("server", 0, 0, payload(500'000), note());
  run();
  ASSERT_EQ(received_.size(), 1u);
  EXPECT_EQ(received_[0].bytes, payload(500'000));
}

TEST_F(HostileTransferTest, AChecksumThatNeverFitsIsRejectedInTheEnd) {
  chunk_t c = chunk(0, 1, 10, 10);
  c.checksum = 99;
  std::string reason;
  bus_.subscribe<chunk_ack_t>("ACK", {}, [&](const chunk_ack_t& ack) {
    if (ack.status == chunk_ack_t::REJECTED) reason = ack.reason;
  });
  for (int i = 0; i < 10; ++i) bus_.publish("DATA", c);
  bus_.dispatch();
  EXPECT_THAT(reason, HasSubstr("checksum"));
  EXPECT_TRUE(received_.empty());
}

TEST_F(HostileTransferTest, HostileAnswersAreHarmless) {
  lose_ = 1;
  const int64_t id = sender_.send("server", 0, 0, payload(300'000), note());
  lose_ = 0;
  chunk_ack_t ack{};
  ack.sender = "client@host:1";
  ack.receiver = "server";
  ack.transfer_id = id;
  ack.missing = {-1, 1 << 30, 5, INT32_MIN, INT32_MAX};
  ack.nmissing = 5;
  for (int32_t next : {-5, INT32_MIN, 3}) {
    ack.next_index = next;
    bus_.publish("ACK", ack);
  }
  chunk_ack_t foreign = ack;
  foreign.receiver = "somebody else";
  foreign.status = chunk_ack_t::COMPLETE;
  bus_.publish("ACK", foreign);
  bus_.dispatch();
  EXPECT_TRUE(results_.empty());
  run();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(received_.at(0).bytes, payload(300'000));
}

TEST_F(HostileTransferTest, RandomChunksHarmNothing) {
  std::mt19937 random(5);
  const auto number = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
  for (int i = 0; i < 10'000; ++i) {
    chunk_t c = chunk(number(6) - 1, number(6) - 1, number(5000) - 100, number(1200));
    c.transfer_id = number(3);
    c.checksum = number(2);
    bus_.publish("DATA", c);
    if (i % 100 == 0) bus_.dispatch(), receiver_->tick(bus_.now_us() + i * 1000);
  }
  bus_.dispatch();
  sender_.send("server", 0, 0, payload(300'000), note());
  run();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_TRUE(results_[0].ok);
}

}  // namespace
}  // namespace rumi
