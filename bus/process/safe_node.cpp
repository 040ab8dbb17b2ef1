// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/safe_node.h"

#include <algorithm>
#include <utility>

#include "base/running/due.h"

namespace rumi {

constexpr int64_t kPauseUs = 100'000;  // pause after a tick that threw

SafeNode::SafeNode(std::unique_ptr<Node> node, Failures* handlers) : node_(std::move(node)), handlers_(handlers) {}

bool SafeNode::waits(int64_t now_us) const { return !is_due(now_us, broke_off_us_, kPauseUs); }

void SafeNode::tick(int64_t now_us) {
  now_us_ = now_us;
  if (waits(now_us)) return;
  broke_off_us_ = kNever_us;
  const std::string reason = thrown_by([&] { node_->tick(now_us); });
  if (reason.empty()) return;
  broke_off_us_ = now_us;
  failures_.note(reason, now_us);
}

int64_t SafeNode::next_tick_us(int64_t now_us) const {
  return waits(now_us) ? broke_off_us_ + kPauseUs : node_->next_tick_us(now_us);
}

NodeStatus SafeNode::status() {
  NodeStatus status;
  failures_.note(thrown_by([&] { status = node_->status(); }), now_us_);
  for (Failures* failures : {&failures_, handlers_}) {
    if (failures->count() == 0) continue;
    status.detail += (status.detail.empty() ? "" : "; ") + failures->text();
    status.degraded = failures->take_news() || status.degraded;
  }
  return status;
}

void SafeNode::finish() {
  failures_.note(thrown_by([&] { node_->finish(); }), now_us_);
}
void SafeNode::stop() {
  failures_.note(thrown_by([&] { node_->stop(); }), now_us_);
}

}  // namespace rumi
