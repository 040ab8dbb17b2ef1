// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transfer/chunked_transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/bus/transfer/transfer_fixture.h"

namespace rumi {
namespace {

using testing::HasSubstr;

TEST_F(TransferTest, WithoutDisturbanceEachChunkIsSentOnce) {
  const int64_t id = sender_.send("server", chunk_t::DATABASE, 5, payload(1'000'000), note());
  bus_.dispatch();
  ASSERT_EQ(received_.size(), 1u);
  EXPECT_EQ(received_[0].bytes, payload(1'000'000));
  EXPECT_EQ(received_[0].sender, "client@host:1");
  EXPECT_EQ(received_[0].kind, chunk_t::DATABASE);
  EXPECT_EQ(received_[0].request_id, 5);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_TRUE(results_[0].ok);
  EXPECT_EQ(results_[0].transfer_id, id);
  EXPECT_EQ(results_[0].revision, 17);
  EXPECT_LE(messages_, 21 + 4);  // messages: chunks and answers
}

TEST_F(TransferTest, AllSizesArriveThoughAThirdIsLostRepeatedAndReordered) {
  lose_ = 0.3, repeat_ = 0.3, reorder_ = 0.3;
  const std::vector<size_t> sizes = {0, 1, 47'999, 48'000, 48'001, 96'000, 96'001, 1'000'000, 5 << 20};
  for (const size_t size : sizes) sender_.send("server", 0, 0, payload(size, static_cast<unsigned>(size)), note());
  const int steps = run();
  ASSERT_EQ(received_.size(), sizes.size());
  for (size_t i = 0; i < sizes.size(); ++i)
    EXPECT_EQ(received_[i].bytes, payload(sizes[i], static_cast<unsigned>(sizes[i]))) << sizes[i];
  ASSERT_EQ(results_.size(), sizes.size());
  for (const TransferResult& result : results_) EXPECT_TRUE(result.ok);
  EXPECT_LT(steps * kTickUs, 60'000'000);
}

TEST_F(TransferTest, AHeavilyDisturbedBusOnlySlowsItDown) {
  lose_ = 0.7, repeat_ = 0.5;
  sender_.send("server", 0, 0, payload(600'000), note());
  run();
  ASSERT_EQ(received_.size(), 1u);
  EXPECT_EQ(received_[0].bytes, payload(600'000));
}

TEST_F(TransferTest, ReceiversAreServedSideBySide) {
  std::vector<size_t> other_sizes;
  const ChunkReceiver other(bus_, "DATA", "ACK", "other", false, [&](const ChunkReceiver::Payload& p) {
    other_sizes.push_back(p.bytes.size());
    return ChunkReceiver::Verdict{};
  });
  sender_.send("nobody", 0, 0, payload(10), note());
  sender_.send("server", 0, 0, payload(20), note());
  sender_.send("other", 0, 0, payload(30), note());
  sender_.send("", 0, 0, payload(40), note());  // for any receiver that accepts it: the server
  step();
  EXPECT_EQ(other_sizes, std::vector<size_t>{30});
  ASSERT_EQ(received_.size(), 2u);
  EXPECT_EQ(received_[1].bytes.size(), 40u);
  EXPECT_EQ(sender_.pending(), 1);
}

TEST_F(TransferTest, UnaddressedChunksAreOnlyForThoseWhoWantThem) {
  receiver_.reset();
  MemoryBus bus;
  ChunkSender sender(bus, "DATA", "ACK", "client");
  const ChunkReceiver receiver(bus, "DATA", "ACK", "server", false, [&](const ChunkReceiver::Payload&) {
    ADD_FAILURE();
    return ChunkReceiver::Verdict{};
  });
  sender.send("", 0, 0, payload(10), note());
  bus.dispatch();
  EXPECT_EQ(sender.pending(), 1);
}

TEST_F(TransferTest, RejectionAndItsReasonReachTheSender) {
  verdict_ = {false, "base_revision 5 is beyond revision 3", 3};
  sender_.send("server", 0, 0, payload(100'000), note());
  bus_.dispatch();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_FALSE(results_[0].ok);
  EXPECT_EQ(results_[0].reason, verdict_.reason);
  EXPECT_EQ(results_[0].revision, 3);
}

TEST_F(TransferTest, WhatIsTooLargeIsRefusedWhereItIsSent) {
  ChunkSender sender(bus_, "DATA", "ACK", "small", {.max_payload_bytes = 5000});
  const int64_t id = sender.send("server", 0, 0, payload(5001), note());
  EXPECT_EQ(sender.pending(), 1);
  EXPECT_TRUE(results_.empty()) << "not before send() has told its number";
  sender.tick(bus_.now_us());
  EXPECT_EQ(sender.pending(), 0);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].transfer_id, id);
  EXPECT_FALSE(results_[0].ok);
  EXPECT_EQ(results_[0].reason, "it is larger than 5000 bytes, the most that is sent at once");
  bus_.dispatch();
  EXPECT_EQ(messages_, 0);
}

TEST_F(TransferTest, AThrowingPayloadHandlerRejects) {
  const ChunkReceiver thrower(
      bus_, "DATA", "ACK", "thrower", false,
      [](const ChunkReceiver::Payload&) -> ChunkReceiver::Verdict { throw std::runtime_error("disk full"); });
  sender_.send("thrower", 0, 0, payload(10), note());
  bus_.dispatch();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].reason, "disk full");
}

TEST_F(TransferTest, NobodyThereIsReportedAfterAMinute) {
  sender_.send("nobody", 0, 0, payload(10), note());
  const int steps = run();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_FALSE(results_[0].ok);
  EXPECT_THAT(results_[0].reason, HasSubstr("no answer from nobody for 60 s"));
  EXPECT_NEAR(static_cast<double>(steps * kTickUs), 60e6, 1e6);
}

TEST_F(TransferTest, AClockThatJumpsIsNoReasonToGiveUp) {
  lose_ = 1;
  sender_.send("server", 0, 0, payload(10), note());
  step();
  bus_.set_now_us(bus_.now_us() + 1'000'000'000);  // a gap in the log that is replayed
  sender_.tick(bus_.now_us());
  lose_ = 0;
  bus_.set_now_us(5);  // the log is played from its beginning again
  run();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_TRUE(results_[0].ok);
}

TEST_F(TransferTest, ALostCompleteIsRepeatedAndThePayloadHandledOnce) {
  sender_.send("server", 0, 0, payload(10), note());
  lose_ = 0;
  int acks = 0;
  bus_.set_tap([&](const std::string& channel, std::span<const uint8_t>) { return channel != "ACK" || ++acks > 3; });
  run();
  EXPECT_EQ(received_.size(), 1u);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_TRUE(results_[0].ok);
}

TEST_F(TransferTest, ARestartedSenderOfTheSameNameIsNotTakenForTheOldOne) {
  // The old process sent some chunks and ended. The clock has not moved: even the transfer number is the same.
  chunk_t old{};
  old.sender = "client@host:1";
  old.receiver = "server";
  old.transfer_id = bus_.now_us();
  old.count = 40;
  old.total_size = 40 * 48'000;
  old.size = 48'000;
  old.data.assign(48'000, 1);
  for (old.index = 0; old.index < 20; ++old.index) bus_.publish("DATA", old);
  bus_.dispatch();
  EXPECT_EQ(sender_.send("server", 0, 0, payload(1'500'000), note()), old.transfer_id);
  run();
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_TRUE(results_[0].ok);
  EXPECT_EQ(received_.at(0).bytes, payload(1'500'000));

  // Finished transfers are told apart as well.
  old = {};
  old.sender = "client@host:1";
  old.receiver = "server";
  old.transfer_id = results_[0].transfer_id;
  old.count = 1;
  bus_.publish("DATA", old);
  bus_.dispatch();
  EXPECT_EQ(received_.size(), 2u);
}

TEST(TransferRestartTest, ARestartedReceiverGetsEverythingAgain) {
  MemoryBus bus;
  bus.set_now_us(1'000'000);
  ChunkSender sender(bus, "DATA", "ACK", "client");
  std::vector<uint8_t> got;
  std::vector<std::unique_ptr<ChunkReceiver>> receivers;
  bool first_is_alive = true;
  const auto handler = [&](const ChunkReceiver::Payload& p) {
    got = p.bytes;
    return ChunkReceiver::Verdict{};
  };
  int chunks = 0;
  bus.set_tap([&](const std::string& channel, std::span<const uint8_t>) {
    // The first receiver dies after 30 chunks; messages that are on their way are lost with it.
    if (channel == "DATA" && ++chunks > 30) first_is_alive = false;
    return first_is_alive || receivers.size() > 1;
  });
  receivers.push_back(std::make_unique<ChunkReceiver>(bus, "DATA", "ACK", "server", false, handler));
  sender.send("server", 0, 0, payload(3'000'000), {});
  bus.dispatch();
  ASSERT_FALSE(first_is_alive);
  ASSERT_TRUE(got.empty());

  MemoryBus second_bus;  // the old receiver must hear nothing more, and its subscription cannot be undone
  second_bus.set_now_us(bus.now_us());
  ChunkReceiver second(second_bus, "DATA", "ACK", "server", false, handler);
  bus.set_tap([&](const std::string& channel, std::span<const uint8_t> data) {
    if (channel == "DATA") second_bus.publish_raw(channel, data);
    return channel == "ACK";
  });
  second_bus.set_tap([&](const std::string& channel, std::span<const uint8_t> data) {
    if (channel == "ACK") bus.publish_raw(channel, data);
    return channel == "DATA";
  });
  for (int i = 0; i < 100 && sender.pending() > 0; ++i) {
    bus.set_now_us(bus.now_us() + kTickUs);
    second_bus.set_now_us(bus.now_us());
    sender.tick(bus.now_us());
    second.tick(bus.now_us());
    while (bus.dispatch() + second_bus.dispatch() > 0) {
    }
  }
  EXPECT_EQ(got, payload(3'000'000));
  EXPECT_EQ(sender.pending(), 0);
}

TEST_F(TransferTest, ProgressFollowsARequest) {
  EXPECT_FALSE(receiver_->progress(9).has_value());
  int chunks = 0;
  bus_.set_tap(
      [&](const std::string& channel, std::span<const uint8_t>) { return channel != "DATA" || ++chunks <= 3; });
  sender_.send("server", chunk_t::DATABASE, 9, payload(480'000), note());
  bus_.dispatch();
  EXPECT_EQ(receiver_->progress(9), std::pair(3, 10));
  bus_.set_tap({});
  run();
  EXPECT_EQ(receiver_->progress(9), std::pair(10, 10));
}

TEST_F(TransferTest, ADoneHandlerMaySendTheNext) {
  sender_.send("server", 0, 0, payload(10),
               [&](const TransferResult&) { sender_.send("server", 0, 0, payload(20), note()); });
  bus_.dispatch();
  EXPECT_EQ(received_.size(), 2u);
  EXPECT_EQ(results_.size(), 1u);
}

}  // namespace
}  // namespace rumi
