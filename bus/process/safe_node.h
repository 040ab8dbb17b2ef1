// SPDX-License-Identifier: BSD-3-Clause
// A node whose process does not end because of what it throws: that is counted, logged now and then, and told in its
// status, and it goes on. (What a handler of messages throws the bus catches, see transport/handler.h.)
#pragma once

#include <memory>
#include <string>

#include "base/failures.h"
#include "bus/process/process.h"

namespace rumi {

class SafeNode : public Node {
 public:
  explicit SafeNode(std::unique_ptr<Node> node);

  // After one that threw the next has to wait a little: one that throws every time must not take all of the CPU.
  void tick(int64_t now_us) override;
  int64_t next_tick_us(int64_t now_us) const override;
  // Degraded if something was thrown since the last one.
  NodeStatus status() override;
  void finish() override;
  void stop() override;
  bool done() const override { return node_->done(); }
  std::string waits_for() const override { return node_->waits_for(); }
  int exit_code() const override { return node_->exit_code(); }
  int64_t handed_on() const override { return node_->handed_on(); }

  Node& node() { return *node_; }
  const Failures& failures() const { return failures_; }

 private:
  bool waits(int64_t now_us) const;
  std::unique_ptr<Node> node_;
  Failures failures_{"a step"};
  int64_t now_us_ = 0;
  int64_t broke_off_us_ = kNever_us;
};

}  // namespace rumi
