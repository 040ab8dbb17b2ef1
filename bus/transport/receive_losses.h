// SPDX-License-Identifier: BSD-3-Clause
// Counts the datagrams that the kernel drops when they come faster than this process takes them: nobody else would
// notice.
#pragma once

#include <cstdint>
#include <set>
#include <string>

namespace rumi {

class ReceiveLosses {
 public:
  // To be made before any socket is opened: sockets that are open already were inherited, and do not count.
  ReceiveLosses();
  // The UDP datagrams that came for this process and found a full receive buffer. Each loses the message that it is a
  // part of. (Column `drops` of /proc/net/udp; 0 without that file.)
  int64_t datagrams() const;

 private:
  std::set<std::string> inherited_;  // inode numbers
};

}  // namespace rumi
