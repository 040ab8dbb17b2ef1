// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/receive_losses.h"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace rumi {
namespace {

// Returns the inode numbers of this process's sockets.
std::set<std::string> open_sockets() {
  const std::string prefix = "socket:[";
  std::set<std::string> inodes;
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/self/fd", error), end; !error && it != end; it.increment(error)) {
    std::error_code closed;
    const std::string target = std::filesystem::read_symlink(it->path(), closed).string();
    if (!closed && target.starts_with(prefix))
      inodes.insert(target.substr(prefix.size(), target.size() - prefix.size() - 1));
  }
  return inodes;
}

}  // namespace

ReceiveLosses::ReceiveLosses() : inherited_(open_sockets()) {}

int64_t ReceiveLosses::datagrams() const {
  constexpr int kInodeField = 9, kDropsField = 12;
  const std::set<std::string> sockets = open_sockets();
  int64_t lost = 0;
  std::ifstream table("/proc/self/net/udp");
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    std::string field, inode;
    int64_t drops = 0;
    for (int i = 0; i < kDropsField && fields >> field; ++i)
      if (i == kInodeField) inode = field;
    if (sockets.contains(inode) && !inherited_.contains(inode) && fields >> drops) lost += drops;
  }
  return lost;
}

}  // namespace rumi
