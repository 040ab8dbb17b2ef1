// SPDX-License-Identifier: BSD-3-Clause
// Counts the datagrams that the kernel drops because they come faster than this process takes them. LCM does not report
// them.
#pragma once

#include <cstdint>
#include <set>
#include <string>

namespace rumi {

class ReceiveLosses {
 public:
  // Construct it before the process opens any socket: sockets that are open already were inherited, and do not count.
  ReceiveLosses();
  // Returns how many UDP datagrams for this process found a full receive buffer. The message that such a datagram is a
  // part of is lost. (Column `drops` of /proc/net/udp; 0 without that file.)
  int64_t datagrams() const;

 private:
  std::set<std::string> inherited_;  // inode numbers of sockets
};

}  // namespace rumi
