# SPDX-License-Identifier: BSD-3-Clause
"""examples_test.py LISTENER EXAMPLES: what the examples print, run as a user would. Run by tests/run_in_netns.sh."""
import pathlib
import select
import subprocess
import sys
import tempfile
import unittest

import rumi

LISTENER, EXAMPLES = sys.argv.pop(1), pathlib.Path(sys.argv.pop(1))
WORDS = "1600000000.250000 position 1.000 -2.000 3.500 rotation (w x y z) 0.5000 0.5000 -0.5000 0.5000\n"
MOST_TRIES = 600  # it only ends what hangs


def pose():
    message = rumi.rigid_transform_t()
    message.utime, message.trans, message.quat = 1_600_000_000_250_000, [1, -2, 3.5], [0.5, 0.5, -0.5, 0.5]
    return message


class Examples(unittest.TestCase):
    def listens(self, command):
        with rumi.lcm.LCM() as bus, subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
            self.addCleanup(listener.kill)
            for _ in range(MOST_TRIES):  # until it has begun to listen
                bus.publish("CAMERA_TO_MAP", b"not a pose")
                bus.publish("CAMERA_TO_MAP", pose())
                if select.select([listener.stdout], [], [], 0.1)[0]:
                    break
            self.assertEqual(listener.stdout.readline(), WORDS)
            self.assertIsNone(listener.poll())
            listener.kill()

    def test_the_listener_in_cpp(self):
        self.listens([LISTENER])

    def test_the_listener_in_python(self):
        self.listens([sys.executable, EXAMPLES / "listener.py"])

    def test_the_reader_of_a_log(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.lcm"
            with rumi.lcm.EventLog(path, "w") as log:
                log.write_event(1, "CAMERA", rumi.rigid_transform_t())
                log.write_event(2, "CAMERA_TO_MAP", pose())
                log.write_event(3, "CAMERA_TO_MAP", pose())
            path.write_bytes(path.read_bytes()[:-1])
            ran = subprocess.run([sys.executable, EXAMPLES / "read_log.py", path], capture_output=True, text=True, check=True)
            heading, poses = ran.stdout.split("\n", 1)
            self.assertTrue(heading.startswith("# time x y z qw qx qy qz"))
            self.assertEqual(poses, "1600000000.250000 1.0 -2.0 3.5 0.5 0.5 -0.5 0.5\n")
            self.assertRegex(ran.stderr, "damaged: 0 bytes passed over, [0-9]+ cut off at the end")


if __name__ == "__main__":
    unittest.main()
