// SPDX-License-Identifier: BSD-3-Clause
// Catches the exceptions of a node, so that its process goes on. Counts them, logs them now and then, and reports them
// in the status. The status also reports the exceptions of the node's message handlers, which the bus catches.
#pragma once

#include <memory>
#include <string>

#include "base/running/failures.h"
#include "bus/process/process.h"

namespace rumi {

class SafeNode : public Node {
 public:
  // `handlers`: the exceptions of the node's message handlers (Bus::broken_handlers). The bus must outlive this object.
  SafeNode(std::unique_ptr<Node> node, Failures* handlers);

  // After a tick that threw, the next one waits a little, so that a tick that always throws does not take all the CPU.
  void tick(int64_t now_us) override;
  int64_t next_tick_us(int64_t now_us) const override;
  // The status is degraded if an exception was caught since the last one.
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
