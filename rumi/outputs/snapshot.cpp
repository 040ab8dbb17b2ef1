// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/snapshot.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/this_process/process_name.h"
#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"

namespace rumi::tool {
namespace {

constexpr int64_t kRepeatUs = 1'000'000;  // of a request that nobody has answered
constexpr int kDispatchMs = 20;

}  // namespace

SnapshotResult request_snapshot(Bus& bus, double timeout_s, double listen_s) {
  SnapshotResult result;
  bool answered = false;
  std::map<std::string, NewestSender> states;  // by process: computers need not agree on the time
  NewestSender map_states("", kLateUs);
  const std::string name = unique_process_name("rumi");
  const int32_t request_id = 1;
  ChunkReceiver receiver(bus, channels::kMapChunk, channels::kMapAck, name, /*accept_unaddressed=*/false,
                         [&](const ChunkReceiver::Payload& payload) -> ChunkReceiver::Verdict {
                           if (payload.request_id != request_id) return {false, "not asked for", 0};
                           answered = true;
                           if (payload.kind == chunk_t::DATABASE) {
                             result.database = payload.bytes;
                           } else {
                             result.error = fmt::format("{} refuses: {}", payload.sender,
                                                        std::string(payload.bytes.begin(), payload.bytes.end()));
                           }
                           return {};
                         });
  bus.subscribe<process_status_t>(channels::kStatus, {}, [&](const process_status_t& status) {
    const auto of_process = states.try_emplace(status.process, "", kLateUs).first;
    if (of_process->second.take(status.utime, bus.now_us())) result.processes[status.process] = status;
  });
  int64_t last_news_us = bus.now_us();
  // It answers when all that it knows is one map, which may take a while.
  bus.subscribe<map_status_t>(channels::kMapStatus, {}, [&](const map_status_t& status) {
    if (!map_states.take(status.utime, bus.now_us())) return;
    result.localized_after_s = status.localized_after_s;
    if (status.merging) last_news_us = bus.now_us();
  });

  const int64_t begin_us = bus.now_us();
  const int64_t timeout_us = std::llround(timeout_s * 1e6), listen_us = std::llround(listen_s * 1e6);
  int64_t last_request_us = 0;
  std::optional<std::pair<int, int>> progress;
  for (int64_t now_us = begin_us; !answered || now_us - begin_us < listen_us; now_us = bus.now_us()) {
    if (!answered && now_us - last_news_us > timeout_us) {
      result.error =
          progress
              ? fmt::format("the map stopped coming after {} of {} pieces", progress->first, progress->second)
              : fmt::format(
                    "no map_server answered within {} s: is one running, with the same --lcm-url and --channel-prefix?",
                    timeout_s);
      return result;
    }
    if (!answered && !progress && now_us - last_request_us >= kRepeatUs) {
      map_request_t request{};
      request.utime = now_us;
      request.requester = name;
      request.request_id = request_id;
      request.what = map_request_t::SNAPSHOT;
      bus.publish(channels::kMapRequest, request);
      last_request_us = now_us;
    }
    bus.dispatch(kDispatchMs);
    receiver.tick(bus.now_us());
    if (const auto news = receiver.progress(request_id); news && news != progress) {
      progress = news;
      last_news_us = bus.now_us();
    }
  }
  return result;
}

}  // namespace rumi::tool
