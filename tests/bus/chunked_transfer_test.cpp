// SPDX-License-Identifier: BSD-3-Clause
#include "bus/chunked_transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "bus/memory_bus.h"

namespace rumi {
namespace {

using testing::HasSubstr;

constexpr int64_t kTickUs = 100'000;

std::vector<uint8_t> payload(size_t size, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<uint8_t> bytes(size);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
  return bytes;
}

// A sender and a receiver on one bus, which may lose, repeat and reorder their messages.
class TransferTest : public testing::Test {
 protected:
  TransferTest() {
    bus_.set_now_us(1'000'000'000);
    bus_.set_tap([this](const std::string& channel, std::span<const uint8_t> data) { return disturb(channel, data); });
  }

  std::unique_ptr<ChunkReceiver> make_receiver(bool accept_unaddressed = true) {
    return std::make_unique<ChunkReceiver>(bus_, "DATA", "ACK", "server", accept_unaddressed,
                                           [this](const ChunkReceiver::Payload& p) {
                                             received_.push_back(p);
                                             return verdict_;
                                           });
  }
  ChunkSender::DoneHandler note() {
    return [this](const TransferResult& result) { results_.push_back(result); };
  }
  void step() {
    bus_.dispatch();
    for (auto& [channel, data] : std::exchange(delayed_, {})) {
      quiet_ = true;
      bus_.publish_raw(channel, data);
      quiet_ = false;
    }
    bus_.dispatch();
    bus_.set_now_us(bus_.now_us() + kTickUs);
    sender_.tick(bus_.now_us());
    if (receiver_) receiver_->tick(bus_.now_us());
  }
  // Steps until nothing is pending; how many steps it took.
  int run(int at_most = 2000) {
    int steps = 0;
    while (sender_.pending() > 0 && steps < at_most) step(), ++steps;
    return steps;
  }
  bool disturb(const std::string& channel, std::span<const uint8_t> data) {
    if (quiet_) return true;
    ++messages_;
    const auto roll = [&] { return std::uniform_real_distribution<double>()(random_); };
    if (roll() < repeat_) delayed_.emplace_back(channel, std::vector<uint8_t>(data.begin(), data.end()));
    if (roll() < lose_) return false;
    if (roll() >= reorder_) return true;
    delayed_.insert(delayed_.begin() + static_cast<ptrdiff_t>(random_() % (delayed_.size() + 1)),
                    {channel, std::vector<uint8_t>(data.begin(), data.end())});
    return false;
  }

  MemoryBus bus_;
  std::mt19937 random_{11};
  double lose_ = 0, repeat_ = 0, reorder_ = 0;
  bool quiet_ = false;
  int messages_ = 0;
  std::vector<std::pair<std::string, std::vector<uint8_t>>> delayed_;
  std::vector<ChunkReceiver::Payload> received_;
  std::vector<TransferResult> results_;
  ChunkReceiver::Verdict verdict_{true, "", 17};
  ChunkSender sender_{bus_, "DATA", "ACK", "client@host:1"};
  std::unique_ptr<ChunkReceiver> receiver_ = make_receiver();
};

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
  EXPECT_LE(messages_, 21 + 4);  // chunks and answers
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
  sender_.send("", 0, 0, payload(40), note());  // whoever accepts it: the server
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
  bus_.set_now_us(5);  // and played from its beginning again
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
    // The first receiver dies after 30 chunks; what is on its way is lost with it.
    if (channel == "DATA" && ++chunks > 30) first_is_alive = false;
    return first_is_alive || receivers.size() > 1;
  });
  receivers.push_back(std::make_unique<ChunkReceiver>(bus, "DATA", "ACK", "server", false, handler));
  sender.send("server", 0, 0, payload(3'000'000), {});
  bus.dispatch();
  ASSERT_FALSE(first_is_alive);
  ASSERT_TRUE(got.empty());

  MemoryBus second_bus;  // the old receiver hears nothing any more: its subscription cannot be undone
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

// --- broken and hostile chunks ---

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

TEST_F(TransferTest, ImplausibleHeadersAreIgnored) {
  for (const chunk_t& c : {
           chunk(-1, 3, 3000, 1000),                   // index
           chunk(3, 3, 3000, 1000),                    //
           chunk(0, 0, 0, 0),                          // count
           chunk(0, -5, 3000, 1000),                   //
           chunk(0, 1, -1, 0),                         // total
           chunk(0, 1, int64_t{1} << 62, 1000),        //
           chunk(0, 1 << 30, int64_t{1} << 40, 1024),  // more than is allowed
           chunk(0, 1, 3000, 1000),                    // sizes that do not add up
           chunk(0, 3, 1000, 1000),                    //
           chunk(0, 3, 2000, 1000),                    //
           chunk(1, 3, 3001, 1000),                    //
           chunk(2, 3, 2501, 500),                     //
           chunk(0, 2, 10, 0),                         //
       }) {
    bus_.publish("DATA", c);
    bus_.dispatch();
    bus_.set_now_us(bus_.now_us() + 1'000'000);
    receiver_->tick(bus_.now_us());
  }
  EXPECT_TRUE(received_.empty());
  EXPECT_EQ(bus_.published(), 13);  // nobody was answered
}

TEST_F(TransferTest, AnnouncedSizesCostNoMemory) {
  // 4 GB each; that much is not set aside for what was merely announced.
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

TEST_F(TransferTest, AHeaderThatChangesStartsAnew) {
  chunk_t a = chunk(0, 2, 2000, 1000), b = chunk(1, 2, 1999, 999);
  a.checksum = 1, b.checksum = 2;
  bus_.publish("DATA", a);
  bus_.publish("DATA", b);
  bus_.dispatch();
  EXPECT_TRUE(received_.empty());
  EXPECT_EQ(receiver_->progress(0), std::pair(1, 2));
}

TEST_F(TransferTest, ADamagedChunkIsAskedForAgain) {
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

TEST_F(TransferTest, AChecksumThatNeverFitsIsRejectedInTheEnd) {
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

TEST_F(TransferTest, HostileAnswersAreHarmless) {
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

TEST_F(TransferTest, RandomChunksHarmNothing) {
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
