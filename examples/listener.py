# SPDX-License-Identifier: BSD-3-Clause
"""Prints where the camera is in the map, as Rumi finds it out."""
import rumi


def on_pose(channel, pose):
    print(f"{pose.utime * 1e-6:.6f} position", *(f"{x:.3f}" for x in pose.trans),
          "rotation (w x y z)", *(f"{x:.4f}" for x in pose.quat), flush=True)


bus = rumi.lcm.LCM()  # the bus in LCM_DEFAULT_URL, else Rumi's
bus.subscribe("CAMERA_TO_MAP", on_pose, rumi.rigid_transform_t)
while True:
    bus.handle()
