// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/memory_bus.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lcmtypes/rumi/map_request_t.hpp"

namespace rumi {
namespace {

map_request_t request(int32_t id) {
  map_request_t message{};
  message.request_id = id;
  return message;
}

TEST(MemoryBusTest, DeliversInTheOrderOfPublishingAcrossChannels) {
  MemoryBus bus;
  std::vector<int> order;
  for (const char* channel : {"A", "B"})
    bus.subscribe<map_request_t>(channel, {}, [&](const map_request_t& m) { order.push_back(m.request_id); });
  for (int i = 0; i < 6; ++i) bus.publish(i % 2 ? "A" : "B", request(i));
  EXPECT_EQ(bus.dispatch(), 6);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(MemoryBusTest, HandlersMayPublishAndDispatchRunsUntilQuiet) {
  MemoryBus bus;
  int answers = 0;
  bus.subscribe<map_request_t>("ASK", {}, [&](const map_request_t& m) {
    if (m.request_id > 0) bus.publish("ASK", request(m.request_id - 1));
    bus.publish("ANSWER", m);
  });
  bus.subscribe<map_request_t>("ANSWER", {}, [&](const map_request_t&) { ++answers; });
  bus.publish("ASK", request(4));
  bus.dispatch();
  EXPECT_EQ(answers, 5);
  EXPECT_EQ(bus.dispatch(), 0);
}

TEST(MemoryBusTest, AThrowingHandlerIsNoBrokenMessageAndTheOthersStillRun) {
  MemoryBus bus;
  int second = 0;
  bus.subscribe<map_request_t>("A", {}, [](const map_request_t&) { throw std::runtime_error("as planned"); });
  bus.subscribe<map_request_t>("A", {}, [&](const map_request_t&) { ++second; });
  bus.publish("A", request(1));
  EXPECT_EQ(bus.dispatch(), 1);
  EXPECT_EQ(second, 1);
  EXPECT_EQ(bus.counts().at(0).undecodable, 0);
  EXPECT_EQ(bus.broken_handlers().text(), "the handling of a message broke off (1 so far): A: as planned");
}

TEST(MemoryBusTest, TheTapSeesAndLosesMessages) {
  MemoryBus bus;
  int handled = 0, seen = 0;
  bus.subscribe<map_request_t>("A", {}, [&](const map_request_t&) { ++handled; });
  bus.set_tap([&](const std::string&, std::span<const uint8_t>) { return ++seen % 2 == 0; });
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(bus.publish("A", request(i)));
  bus.publish("NOBODY", request(9));
  bus.dispatch();
  EXPECT_EQ(seen, 5);
  EXPECT_EQ(handled, 2);
  EXPECT_EQ(bus.published(), 5);
}

// Behaves like generated code with a message beyond 2 GiB: its size has wrapped around, so that it is negative or too
// small for the encoding.
struct HugeMessage {
  int size = 0;
  int getEncodedSize() const { return size; }
  int encode(void*, int, int) const { return -1; }
};

TEST(EncodeMessageTest, WhatIsTooLargeIsRefusedWhereItIsMade) {
  MemoryBus bus;
  for (const int wrapped : {-8, 100}) {
    EXPECT_THROW(encode_message(HugeMessage{wrapped}), std::length_error);
    EXPECT_FALSE(bus.publish("X", HugeMessage{wrapped}));
  }
  EXPECT_EQ(bus.published(), 0);
}

}  // namespace
}  // namespace rumi
