// SPDX-License-Identifier: BSD-3-Clause
#include <lcm/lcm-cpp.hpp>

#include "lcmtypes/rumi/track_t.hpp"

int main() {
  rumi::track_t sent{}, received;
  sent.submap_id = 7;
  std::vector<uint8_t> bytes(sent.getEncodedSize());
  sent.encode(bytes.data(), 0, int(bytes.size()));
  received.decode(bytes.data(), 0, int(bytes.size()));
  lcm::LCM lcm("memq://");
  return lcm.good() && received.submap_id == 7 ? 0 : 1;
}
