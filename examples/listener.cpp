// SPDX-License-Identifier: BSD-3-Clause
// Prints the camera's pose in the map, as Rumi publishes it.
#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "lcmtypes/rumi/rigid_transform_t.hpp"

class Listener {
 public:
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const rumi::rigid_transform_t* pose) {
    const double *t = pose->trans, *q = pose->quat;
    std::printf("%.6f position %.3f %.3f %.3f rotation (w x y z) %.4f %.4f %.4f %.4f\n", pose->utime * 1e-6, t[0], t[1],
                t[2], q[0], q[1], q[2], q[3]);
    std::fflush(stdout);
  }
};

int main() {
  lcm::LCM lcm;  // the bus in LCM_DEFAULT_URL, else LCM's own, which is Rumi's
  Listener listener;
  if (!lcm.good() || !lcm.subscribe("CAMERA_TO_MAP", &Listener::on_pose, &listener)) return 1;
  while (lcm.handle() == 0) continue;
  return 1;
}
