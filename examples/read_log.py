# SPDX-License-Identifier: BSD-3-Clause
"""read_log.py LOG: prints the poses in a log of lcm-logger."""
import sys

import rumi

print("# time x y z qw qx qy qz (TUM's files have qx qy qz qw)")
with rumi.lcm.EventLog(sys.argv[1]) as log:
    for event in log:
        if event.channel == "CAMERA_TO_MAP":
            pose = rumi.lcm.decode(event.data, rumi.rigid_transform_t)
            print(f"{pose.utime * 1e-6:.6f}", *pose.trans, *pose.quat)
    if log.skipped_bytes or log.cut_off_bytes:
        print(f"damaged: {log.skipped_bytes} bytes passed over, {log.cut_off_bytes} cut off at the end", file=sys.stderr)
