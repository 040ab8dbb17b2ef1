// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/memory_bus.h"

namespace rumi {

inline constexpr int64_t kTickUs = 100'000;

inline std::vector<uint8_t> payload(size_t size, unsigned seed = 1) {
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
  // Steps until nothing is pending. Returns the number of steps.
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

}  // namespace rumi
