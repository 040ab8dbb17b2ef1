# SPDX-License-Identifier: BSD-3-Clause
"""python_bus_test.py LCM_PEER: rumi.lcm and LCM's own library on one bus. Run by tests/run_in_netns.sh."""
import os
import random
import socket
import subprocess
import sys
import unittest

import rumi
from rumi.lcm import LCM

PEER = sys.argv.pop(1)
GROUP = ("239.255.76.67", 7667)
LONG_MS = 60_000  # it only ends what hangs


def pose(utime):
    message = rumi.rigid_transform_t()
    message.utime = utime
    return message


class Bus(unittest.TestCase):
    def setUp(self):
        self.bus, self.other = LCM(), LCM("udpm://239.255.76.67:7667?ttl=0")
        self.heard = []
        self.addCleanup(self.bus.close)
        self.addCleanup(self.other.close)

    def hear(self, channel, message):
        self.heard.append((channel, message))

    def test_lcms_library_hears_us_and_we_hear_it(self):
        self.bus.subscribe("FROM_CPP", self.hear)
        with subprocess.Popen([PEER, "echo"], stdout=subprocess.PIPE, text=True) as peer:
            self.addCleanup(peer.kill)
            self.assertEqual(peer.stdout.readline(), "ready\n")
            sent = [random.Random(size).randbytes(size) for size in (0, 1, 65491, 65492, 65493, 65494, 65500, 130_000, 200_000)]
            for data in sent:
                self.bus.publish("TO_CPP", data)
                self.assertTrue(self.bus.handle_timeout(LONG_MS))
            self.bus.publish("END", b"")
            self.assertEqual(peer.wait(60), 0)
        self.assertEqual(self.heard, [("FROM_CPP", data) for data in sent])
        self.assertEqual((self.bus.received, self.bus.lost, self.bus.not_lcm), (len(sent), 0, 0))

    def test_messages_are_decoded_and_broken_ones_counted(self):
        self.bus.subscribe("POSE", self.hear, rumi.rigid_transform_t)
        for data in (pose(1), b"no pose", pose(2).encode()[:-1], b"", rumi.track_t(), pose(3)):
            self.other.publish("POSE", data)
        self.bus.handle()
        self.bus.handle()
        self.assertEqual([message.utime for _, message in self.heard], [1, 3])
        self.assertEqual(self.bus.undecodable, 4)

    def test_channels_are_regular_expressions_of_whole_names(self):
        any_map = self.bus.subscribe("RUMI_.*", self.hear)
        for channel in ("A_RUMI_TRACK", "RUMI_TRACK", "RUMI_STATUS"):
            self.other.publish(channel, b"")
        self.bus.handle()
        self.bus.handle()
        self.assertEqual([channel for channel, _ in self.heard], ["RUMI_TRACK", "RUMI_STATUS"])
        self.bus.unsubscribe(any_map)
        self.other.publish("RUMI_TRACK", b"")
        self.assertFalse(self.bus.handle_timeout(0))

    def test_garbage_on_the_bus_is_counted_and_passed_over(self):
        self.bus.subscribe("C", self.hear)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            for garbage in (b"", b"x", b"LC02", b"LC03" + b"\xff" * 50, os.urandom(60_000)):
                stranger.sendto(garbage, GROUP)
        self.other.publish("C", b"message")
        self.bus.handle()
        self.assertEqual((self.heard, self.bus.not_lcm), ([("C", b"message")], 5))

    def test_what_a_full_buffer_lost_is_counted(self):
        slow = LCM("udpm://239.255.76.67:7667?recv_buf_size=4096")
        self.addCleanup(slow.close)
        slow.subscribe("C", self.hear)
        for i in range(100):
            self.other.publish("C", bytes(1000))
        while slow.handle_timeout(0):
            pass
        # The next one tells.
        self.other.publish("C", b"")
        self.assertTrue(slow.handle_timeout(LONG_MS))
        self.assertGreater(slow.lost, 0)
        self.assertEqual(slow.received + slow.lost, 101)

    def test_another_group_at_the_same_port_is_another_bus(self):
        subprocess.run(["ip", "route", "add", "239.255.76.68/32", "dev", "lo"], check=True)
        elsewhere = LCM("udpm://239.255.76.68:7667?ttl=0")
        self.addCleanup(elsewhere.close)
        elsewhere.subscribe("C", self.hear)
        self.bus.subscribe("C", lambda *_: self.fail("heard another bus"))
        elsewhere.publish("C", b"elsewhere")
        elsewhere.handle()
        self.assertFalse(self.bus.handle_timeout(0))

    def test_without_a_route_it_says_what_to_do(self):
        with self.assertRaisesRegex(OSError, r"239.255.76.99:7667 cannot be used: .*(?s:.)*ip route add 239.255.76.99/32 dev lo"):
            LCM("udpm://239.255.76.99:7667")

    def test_handle_without_a_subscription_does_not_wait_for_ever(self):
        with self.assertRaisesRegex(RuntimeError, "there is no subscription"):
            self.bus.handle()
        self.assertFalse(self.bus.handle_timeout(1))

    def test_the_url_is_that_of_the_environment(self):
        os.environ["LCM_DEFAULT_URL"] = "udpm://239.255.76.67:7668?ttl=0"
        self.addCleanup(os.environ.pop, "LCM_DEFAULT_URL")
        with LCM() as bus:
            self.assertEqual(bus.url, "udpm://239.255.76.67:7668?ttl=0")


if __name__ == "__main__":
    unittest.main()
