// SPDX-License-Identifier: BSD-3-Clause
// Catches what a node throws, so that its process goes on. It counts the exceptions, logs them now and then, and tells
// of them in the status; so it does of what the node's message handlers throw, which the bus catches.
#pragma once

#include <memory>
#include <string>

#include "base/running/failures.h"
#include "bus/process/process.h"

namespace rumi {

class SafeNode : public Node {
 public:
  // `handlers`: those of the node's bus (Bus::broken_handlers), which outlives it.
  SafeNode(std::unique_ptr<Node> node, Failures* handlers);

  // After a tick that threw, the next one waits a little, so that a tick that always throws does not take all the CPU.
  void tick(int64_t now_us) override;
  int64_t next_tick_us(int64_t now_us) const override;
  // Degraded if something was thrown since the last one.
  NodeStatus status() override;
  void finish() override;
  void stop() override;
  bool done() const override { return node_->done(); }
  std::string waits_for() const override { return node_->waits_for(); }
  std::vector<std::string> complaints() const override { return node_->complaints(); }
  int64_t handed_on() const override { return node_->handed_on(); }

  Node& node() { return *node_; }
  const Failures& failures() const { return failures_; }

 private:
  bool waits(int64_t now_us) const;
  std::unique_ptr<Node> node_;
  Failures* handlers_;
  Failures failures_{"a step"};
  int64_t now_us_ = 0;
  int64_t broke_off_us_ = kNever_us;
};

}  // namespace rumi
