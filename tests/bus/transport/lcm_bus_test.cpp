// SPDX-License-Identifier: BSD-3-Clause
// Tests LcmBus on real multicast; run by tests/run_in_netns.sh.
#include "bus/transport/lcm_bus.h"
#include "base/or_throw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <stdexcept>

#include "base/this_process/process_name.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/support/patience.h"

namespace rumi {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Clock = std::chrono::steady_clock;
using testing::happens;
using testing::kPatience;

std::unique_ptr<LcmBus> open_bus(const ChannelNames& names = {}) {
  return or_throw(LcmBus::open(kDefaultLcmUrl, names));
}

map_request_t request(int32_t id) {
  map_request_t message{};
  message.request_id = id;
  return message;
}

bool dispatch_until(Bus& bus, const std::function<bool()>& done) {
  return happens(done, [&bus] { bus.dispatch(10); });
}

// Waits until `count` messages have arrived, handled or not. Returns false if they do not come.
bool wait_for_received(const Bus& bus, int64_t count) {
  return happens([&] {
    int64_t sum = 0;
    for (const ChannelCounts& c : bus.counts()) sum += c.received;
    return sum >= count;
  });
}

TEST(LcmBusTest, MessagesArriveInOrderAcrossChannels) {
  const auto sender = open_bus(), receiver = open_bus();
  std::vector<int> order;
  for (const char* channel : {"A", "B", "C"})
    receiver->subscribe<map_request_t>(channel, {.capacity = 100},
                                       [&](const map_request_t& m) { order.push_back(m.request_id); });
  for (int i = 0; i < 90; ++i) EXPECT_TRUE(sender->publish(i % 3 == 0 ? "C" : i % 3 == 1 ? "A" : "B", request(i)));
  ASSERT_TRUE(wait_for_received(*receiver, 90));
  EXPECT_EQ(receiver->dispatch(0), 90);
  for (int i = 0; i < 90; ++i) EXPECT_EQ(order.at(i), i);
  EXPECT_EQ(sender->published(), 90);
}

TEST(LcmBusTest, RawImagesArriveWhole) {
  const auto sender = open_bus(), receiver = open_bus();
  image_t image{};
  image.width = image.row_stride = 640;
  image.height = 480;
  image.pixelformat = image_t::PIXEL_FORMAT_GRAY;
  image.data.resize(640 * 480);
  image.size = 640 * 480;
  int received = 0;
  receiver->subscribe<image_t>(channels::kCamera, {.capacity = 30}, [&](const image_t& m) {
    EXPECT_EQ(m.utime, received);
    EXPECT_EQ(m.data.front(), static_cast<uint8_t>(received));
    EXPECT_EQ(m.data.back(), static_cast<uint8_t>(received));
    ++received;
  });
  const auto start = Clock::now();
  constexpr int kImages = 400, kAtATime = 4;  // four images fit into the kernel's buffer however busy the machine is
  for (int i = 0; i < kImages; ++i) {
    image.utime = i;
    std::fill(image.data.begin(), image.data.end(), static_cast<uint8_t>(i));
    ASSERT_TRUE(sender->publish(channels::kCamera, image));
    if (i % kAtATime != kAtATime - 1) continue;
    ASSERT_TRUE(dispatch_until(*receiver, [&] { return received == i + 1; })) << i;
  }
  EXPECT_EQ(received, kImages);
  EXPECT_EQ(receiver->counts().at(0).dropped, 0);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  RecordProperty("images_per_second", std::to_string(kImages / seconds));
}

TEST(LcmBusTest, AFullQueueDropsByItsPolicyAndCounts) {
  const auto sender = open_bus(), receiver = open_bus();
  std::vector<int> latest, earliest;
  receiver->subscribe<map_request_t>("A", {.capacity = 3, .drop = DropPolicy::kDropOldest},
                                     [&](const map_request_t& m) { latest.push_back(m.request_id); });
  receiver->subscribe<map_request_t>("A", {.capacity = 3, .drop = DropPolicy::kDropNewest},
                                     [&](const map_request_t& m) { earliest.push_back(m.request_id); });
  for (int i = 0; i < 10; ++i) sender->publish("A", request(i));
  ASSERT_TRUE(wait_for_received(*receiver, 20));
  EXPECT_EQ(receiver->counts().at(0).queue_depth, 3);
  EXPECT_EQ(receiver->dispatch(0), 6);
  EXPECT_THAT(latest, ElementsAre(7, 8, 9));
  EXPECT_THAT(earliest, ElementsAre(0, 1, 2));
  for (const ChannelCounts& c : receiver->counts()) {
    EXPECT_EQ(c.received, 10);
    EXPECT_EQ(c.dropped, 7);
    EXPECT_EQ(c.queue_depth, 0);
  }
}

TEST(LcmBusTest, BrokenMessagesAndThrowingHandlersAreCountedApart) {
  const auto sender = open_bus(), receiver = open_bus();
  receiver->subscribe<map_request_t>("A", {}, [](const map_request_t& m) {
    if (m.request_id == 13) throw std::runtime_error("as planned");
  });
  sender->publish_raw("A", {});
  sender->publish_raw("A", std::vector<uint8_t>(100, 0xff));
  sender->publish("A", request(13));
  sender->publish("A", request(14));
  ASSERT_TRUE(wait_for_received(*receiver, 4));
  EXPECT_EQ(receiver->dispatch(0), 4);
  EXPECT_EQ(receiver->counts().at(0).undecodable, 2);
  EXPECT_EQ(receiver->broken_handlers().count(), 1);
}

TEST(LcmBusTest, ChannelNamesAreExactAndNoPatterns) {
  const auto sender = open_bus(), receiver = open_bus();
  int dots = 0, end = 0;
  receiver->subscribe<map_request_t>("A.B", {}, [&](const map_request_t&) { ++dots; });
  receiver->subscribe<map_request_t>("END", {}, [&](const map_request_t&) { ++end; });
  for (const char* channel : {"AxB", "A.B", "A.BC", "xA.B", "END"}) sender->publish(channel, request(1));
  ASSERT_TRUE(dispatch_until(*receiver, [&] { return end == 1; }));
  EXPECT_EQ(dots, 1);
}

TEST(LcmBusTest, APrefixAndACameraNameKeepRobotsApart) {
  const auto one = open_bus({"one/", "LEFT"}), two = open_bus({"two/", "LEFT"}), plain = open_bus();
  int at_one = 0, at_two = 0, at_plain = 0;
  one->subscribe<map_request_t>(channels::kCamera, {}, [&](const map_request_t&) { ++at_one; });
  two->subscribe<map_request_t>(channels::kCamera, {}, [&](const map_request_t&) { ++at_two; });
  plain->subscribe<map_request_t>("one/LEFT", {}, [&](const map_request_t&) { ++at_plain; });
  one->publish(channels::kCamera, request(1));
  EXPECT_TRUE(dispatch_until(*one, [&] { return at_one == 1; }));
  EXPECT_TRUE(dispatch_until(*plain, [&] { return at_plain == 1; }));
  two->dispatch(50);
  EXPECT_EQ(at_two, 0);
  EXPECT_EQ(one->counts().at(0).channel, channels::kCamera);
}

TEST(LcmBusTest, ManyThreadsMayPublish) {
  const auto sender = open_bus(), receiver = open_bus();
  int64_t sum = 0;
  receiver->subscribe<map_request_t>("A", {.capacity = 1000}, [&](const map_request_t& m) { sum += m.request_id; });
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 1; i <= 100; ++i) sender->publish("A", request(i));
    });
  for (std::thread& thread : threads) thread.join();
  ASSERT_TRUE(wait_for_received(*receiver, 400));
  receiver->dispatch(0);
  EXPECT_EQ(sum, 4 * 5050);
  EXPECT_EQ(sender->published(), 400);
}

TEST(LcmBusTest, DispatchWaitsForAMessageOrForItsTime) {
  const auto sender = open_bus(), receiver = open_bus();
  receiver->subscribe<map_request_t>("A", {}, [](const map_request_t&) {});
  EXPECT_EQ(receiver->dispatch(1), 0);
  const std::jthread later([&sender] { sender->publish("A", request(1)); });
  EXPECT_EQ(receiver->dispatch(std::chrono::milliseconds(kPatience).count()), 1);
}

TEST(LcmBusTest, EndsInTheMiddleOfAFlood) {
  const auto sender = open_bus();
  std::atomic<bool> stop = false;
  std::thread flood([&] {
    while (!stop) sender->publish("A", request(1)), std::this_thread::sleep_for(std::chrono::microseconds(100));
  });
  for (int i = 0; i < 5; ++i) {
    auto receiver = open_bus();
    receiver->subscribe<map_request_t>("A", {.capacity = 2}, [](const map_request_t&) {});
    EXPECT_TRUE(wait_for_received(*receiver, 20));
    receiver->dispatch(0);
    receiver.reset();  // must not wait for the end of the flood, which comes later
  }
  stop = true;
  flood.join();
}

TEST(LcmBusTest, AFloodDoesNotKeepDispatchFromReturning) {
  const auto bus = open_bus();
  bus->subscribe<map_request_t>("A", {.capacity = 10'000}, [&](const map_request_t& m) {
    bus->publish("A", m);  // for ever
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  });
  for (int i = 0; i < 20; ++i) bus->publish("A", request(i));
  ASSERT_TRUE(wait_for_received(*bus, 20));
  EXPECT_LE(bus->dispatch(0), 40);
}

TEST(LcmBusTest, ALargePayloadArrivesInChunks) {
  const auto client = open_bus(), server = open_bus();
  std::vector<uint8_t> got;
  ChunkReceiver receiver(*server, channels::kSubmap, channels::kSubmapAck, "map_server", true,
                         [&](const ChunkReceiver::Payload& p) {
                           got = p.bytes;
                           return ChunkReceiver::Verdict{};
                         });
  ChunkSender sender(*client, channels::kSubmap, channels::kSubmapAck, unique_process_name("test"));
  std::vector<uint8_t> payload(20'000'000);
  for (size_t i = 0; i < payload.size(); ++i) payload[i] = static_cast<uint8_t>(i * 2654435761u >> 24);
  bool ok = false;
  sender.send("map_server", 0, 0, payload, [&](const TransferResult& r) { ok = r.ok; });
  const auto start = Clock::now();
  while (sender.pending() > 0 && Clock::now() < start + kPatience) {
    server->dispatch(1);
    client->dispatch(1);
    receiver.tick(server->now_us());
    sender.tick(client->now_us());
  }
  EXPECT_TRUE(ok);
  EXPECT_EQ(got, payload);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  RecordProperty("megabytes_per_second", std::to_string(20 / seconds));
}

TEST(LcmBusTest, WithoutARouteItSaysWhatToDo) {
  const std::string error = LcmBus::open("udpm://239.255.76.99:7667?ttl=0", {}).error_text();
  EXPECT_THAT(error, HasSubstr("cannot be used: Network is unreachable"));
  EXPECT_THAT(error, HasSubstr("sudo ip link set lo multicast on"));
  EXPECT_THAT(error, HasSubstr("sudo ip route add 239.255.76.99/32 dev lo"));
  EXPECT_THAT(LcmBus::open("nonsense://x", {}).error_text(), HasSubstr("Expected an LCM URL"));
}

// LCM itself ends the process if a server of tcpq is missing; memq and file reach no other process.
TEST(LcmBusTest, BusesThatAreNoneForSeveralProcessesAreRefusedByName) {
  const auto why = [](const std::string& url) {
    const std::string error = LcmBus::open(url, {}).error_text();
    EXPECT_THAT(error, HasSubstr("the LCM URL " + url + " is not used: "));
    EXPECT_THAT(error, HasSubstr("udpm://239.255.76.67:7667?ttl=0"));
    EXPECT_THAT(error, Not(HasSubstr("route")));
    return error;
  };
  for (const char* url : {"tcpq://127.0.0.1:7700", "tcpq://", "udp://239.255.76.67:7667", "239.255.76.67:7667"})
    EXPECT_THAT(why(url), HasSubstr("only udpm:// is, multicast"));
  EXPECT_THAT(why("memq://"), HasSubstr("lives within one process"));
  EXPECT_THAT(why("file:///tmp/x.lcm?mode=w"), HasSubstr("a log file and no bus"));
}

TEST(LcmBusTest, AnAddressThatIsNoMulticastAddressIsRefusedByName) {
  for (const char* address : {"10.0.0.5", "127.0.0.1", "192.168.1.255", "240.0.0.1", "localhost", "239.255.76"}) {
    const std::string error = LcmBus::open(std::string("udpm://") + address + ":7667?ttl=0", {}).error_text();
    EXPECT_THAT(error, HasSubstr(std::string(address) + " is no multicast address (224.0.0.0 to 239.255.255.255)"));
    EXPECT_THAT(error, Not(HasSubstr("route")));
  }
}

TEST(LcmBusTest, AUrlWithoutAPortIsRefusedAtOnce) {
  for (const char* url : {"udpm://239.255.76.67?ttl=0", "udpm://239.255.76.67:?ttl=0", "udpm://239.255.76.67:99999",
                          "udpm://239.255.76.67:0", "udpm://239.255.76.67:port"}) {
    EXPECT_THAT(LcmBus::open(url, {}).error_text(),
                HasSubstr("has no port from 1 to 65535; a usual one is udpm://239.255.76.67:7667?ttl=0"));
  }
}

TEST(LcmBusTest, NamesTooLongForLcmAreRefusedAtOnce) {
  EXPECT_THAT(LcmBus::open(kDefaultLcmUrl, {std::string(60, 'x'), "CAMERA"}).error_text(),
              HasSubstr("at most 63 characters"));
}

}  // namespace
}  // namespace rumi
