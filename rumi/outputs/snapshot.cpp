// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/snapshot.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "base/text/time_units.h"
#include "base/this_process/process_name.h"
#include "bus/process/newest_sender.h"
#include "bus/process/process.h"
#include "bus/transfer/chunked_transfer.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"

namespace rumi::tool {
namespace {

constexpr int64_t kRepeatUs = 1'000'000;  // the request is repeated until the first part of an answer arrives
constexpr int kDispatchMs = 20;
constexpr int32_t kRequestId = 1;

class SnapshotRequest {
 public:
  SnapshotRequest(Bus& bus, double timeout_s)
      : bus_(bus),
        timeout_s_(timeout_s),
        receiver_(bus, channels::kMapChunk, channels::kMapAck, name_, /*accept_unaddressed=*/false,
                  [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); }),
        last_news_us_(bus.now_us()) {
    bus.subscribe<process_status_t>(channels::kStatus, {}, [this](const auto& status) { on_process(status); });
    bus.subscribe<map_status_t>(channels::kMapStatus, {}, [this](const auto& status) { on_map(status); });
  }

  bool is_answered() const { return answered_; }
  Result<Snapshot> result() const { return error_ ? Result<Snapshot>(*error_) : snapshot_; }

  // Listens for a short time, and repeats the request if necessary. An Error if nothing of an answer has come for
  // timeout_s.
  Result<> step() {
    const int64_t now_us = bus_.now_us();
    if (!answered_ && now_us - last_news_us_ > to_us(timeout_s_)) return silence();
    if (!answered_ && !progress_ && now_us - last_request_us_ >= kRepeatUs) request(now_us);
    bus_.dispatch(kDispatchMs);
    receiver_.tick(bus_.now_us());
    if (const auto news = receiver_.progress(kRequestId); news && news != progress_) {
      progress_ = news;
      last_news_us_ = bus_.now_us();
    }
    return {};
  }

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload) {
    if (payload.request_id != kRequestId) return {false, "not asked for", 0};
    answered_ = true;
    if (payload.kind == chunk_t::DATABASE)
      snapshot_.database = payload.bytes;
    else
      error_ =
          Error{fmt::format("{} refuses: {}", payload.sender, std::string(payload.bytes.begin(), payload.bytes.end()))};
    return {};
  }
  void on_process(const process_status_t& status) {
    NewestSender& senders = states_.try_emplace(status.process, "", kLateUs).first->second;
    if (senders.take(status.utime, bus_.now_us())) snapshot_.processes[status.process] = status;
  }
  // map_server answers only after it has joined all submaps. While it says that it is joining, the time to wait begins
  // anew.
  void on_map(const map_status_t& status) {
    if (!map_states_.take(status.utime, bus_.now_us())) return;
    snapshot_.localized_after_s = status.localized_after_s;
    if (status.merging) last_news_us_ = bus_.now_us();
  }
  void request(int64_t now_us) {
    map_request_t request{};
    request.utime = now_us;
    request.requester = name_;
    request.request_id = kRequestId;
    request.what = map_request_t::SNAPSHOT;
    bus_.publish(channels::kMapRequest, request);
    last_request_us_ = now_us;
  }
  Error silence() const {
    if (progress_)
      return Error{fmt::format("the map stopped coming after {} of {} pieces", progress_->first, progress_->second)};
    return Error{
        fmt::format("no map_server answered within {} s: is one running, with the same --lcm-url and --channel-prefix?",
                    timeout_s_)};
  }

  Bus& bus_;
  const double timeout_s_;
  const std::string name_ = unique_process_name("rumi");
  std::map<std::string, NewestSender> states_;  // by process; computers may have different clocks
  NewestSender map_states_{"", kLateUs};
  ChunkReceiver receiver_;
  Snapshot snapshot_;
  std::optional<Error> error_;
  bool answered_ = false;
  std::optional<std::pair<int, int>> progress_;
  int64_t last_request_us_ = 0, last_news_us_;
};

}  // namespace

Result<Snapshot> request_snapshot(Bus& bus, double timeout_s, double listen_s) {
  SnapshotRequest request(bus, timeout_s);
  for (const int64_t begin_us = bus.now_us(); !request.is_answered() || bus.now_us() - begin_us < to_us(listen_s);)
    if (const Result<> step = request.step(); !step) return step.error();
  return request.result();
}

}  // namespace rumi::tool
