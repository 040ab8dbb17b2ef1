# SPDX-License-Identifier: BSD-3-Clause
"""python_lcm_test.py LCM_PEER: rumi.lcm without a network: messages, logs, datagrams, and what is broken of them."""
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import unittest

sys.modules["lcm"] = None  # an import of LCM's own package fails
import rumi  # noqa: E402
from rumi.lcm import datagrams  # noqa: E402

PEER = sys.argv.pop(1)


def pose(utime=5):
    message = rumi.rigid_transform_t()
    message.utime, message.trans, message.quat = utime, [1.0, 2.0, 3.0], [1.0, 0.0, 0.0, 0.0]
    return message


def image():
    message, metadata = rumi.image_t(), rumi.image_metadata_t()
    message.utime, message.size, message.data = 7, 3, b"abc"
    metadata.key, metadata.n, metadata.value = "calibration", 2, b"xy"
    message.nmetadata, message.metadata = 1, [metadata]
    return message


class Messages(unittest.TestCase):
    def test_a_message_is_known_by_its_fingerprint(self):
        decoded = rumi.lcm.decode(image().encode())
        self.assertIsInstance(decoded, rumi.image_t)
        self.assertEqual((decoded.utime, decoded.data, decoded.metadata[0].key), (7, b"abc", "calibration"))

    def test_another_type_is_refused_with_both_fingerprints(self):
        with self.assertRaisesRegex(ValueError, "no image_t: the fingerprint is [0-9a-f]{16}, not [0-9a-f]{16}"):
            rumi.lcm.decode(pose().encode(), rumi.image_t)
        with self.assertRaisesRegex(ValueError, "ffffffffffffffff is of no type of rumi"):
            rumi.lcm.decode(b"\xff" * 20)

    def test_a_message_that_is_cut_off_anywhere_is_refused(self):
        data = image().encode()
        for size in range(len(data)):
            with self.assertRaises(ValueError):
                rumi.lcm.decode(data[:size])

    def test_lengths_that_cannot_be_are_refused(self):
        data = bytearray(image().encode())
        for length in (-1, -5, 2**31 - 1):
            data[8 + 24:8 + 28] = struct.pack(">i", length)
            with self.assertRaisesRegex(ValueError, "a broken image_t: .* bytes are wanted at"):
                rumi.lcm.decode(data)

    def test_any_bytes_are_a_message_or_a_value_error(self):
        chance = random.Random(1)
        for _ in range(3000):
            data = bytearray(image().encode())
            for _ in range(chance.randint(1, 4)):
                data[chance.randrange(8, len(data))] = chance.choice((0, 1, 127, 128, 255))
            try:
                rumi.lcm.decode(data)
            except ValueError:
                pass


class Logs(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name) / "a.lcm"

    def tearDown(self):
        self.folder.cleanup()

    def write(self, count=5):
        with rumi.lcm.EventLog(self.path, "w") as log:
            for i in range(count):
                log.write_event(1000 + i, f"CHANNEL_{i}", pose(i))
        return self.path.read_bytes()

    def read(self, data=None):
        if data is not None:
            self.path.write_bytes(data)
        with rumi.lcm.EventLog(self.path) as log:
            return list(log), log.skipped_bytes, log.cut_off_bytes

    def test_what_was_written_is_read(self):
        self.write()
        events, skipped, cut_off = self.read()
        self.assertEqual([(e.eventnum, e.timestamp, e.channel) for e in events], [(i, 1000 + i, f"CHANNEL_{i}") for i in range(5)])
        self.assertEqual([rumi.lcm.decode(e.data).utime for e in events], list(range(5)))
        self.assertEqual((skipped, cut_off), (0, 0))

    def test_a_log_is_not_overwritten_unasked(self):
        self.write()
        with self.assertRaises(FileExistsError):
            rumi.lcm.EventLog(self.path, "w")
        rumi.lcm.EventLog(self.path, "w", overwrite=True).close()
        self.assertEqual(self.read(), ([], 0, 0))

    def test_lcms_library_reads_what_we_wrote_and_we_what_it_wrote(self):
        written = self.write(20)
        copied = self.path.with_name("copy.lcm")
        subprocess.run([PEER, "copy", self.path, copied], check=True)
        self.assertEqual(copied.read_bytes(), written)

    def test_a_log_cut_off_anywhere_has_the_events_before(self):
        data = self.write(3)
        size = len(data) // 3
        for end in range(1, len(data)):
            events, skipped, cut_off = self.read(data[:end])
            self.assertEqual((len(events), skipped, cut_off), (end // size, 0, end % size))

    def test_damage_within_is_passed_over_and_counted(self):
        data = self.write(3)
        size = len(data) // 3
        for what, damage in (("sync", (size, b"\0")), ("channel size", (size + 20, b"\xff")), ("data size", (size + 24, b"\x7f"))):
            at, piece = damage
            events, skipped, _ = self.read(data[:at] + piece + data[at + 1:])
            self.assertEqual(([e.eventnum for e in events], skipped), ([0, 2], size), what)
        events, skipped, _ = self.read(b"garbage" + data)
        self.assertEqual((len(events), skipped), (3, 7))

    def test_any_damage_leaves_events_or_is_refused(self):
        data, chance = self.write(20), random.Random(4)
        for _ in range(300):
            damaged = bytearray(data)
            for _ in range(chance.randint(1, 30)):
                damaged[chance.randrange(len(damaged))] = chance.randrange(256)
            try:
                events, _, _ = self.read(damaged[:chance.randint(1, len(damaged))])
                self.assertLessEqual(len(events), 20)
            except ValueError as error:
                self.assertIn("not an LCM log", str(error))

    def test_what_is_appended_is_read_on(self):
        data = self.write(2)
        self.path.write_bytes(data[:-1])
        with rumi.lcm.EventLog(self.path) as log:
            self.assertEqual(log.read_next_event().eventnum, 0)
            self.assertIsNone(log.read_next_event())
            self.path.write_bytes(data)
            self.assertEqual(log.read_next_event().eventnum, 1)
            self.assertEqual(log.cut_off_bytes, 0)

    def test_another_file_is_refused_by_name(self):
        self.path.write_bytes(b"SQLite format 3\0" + bytes(5000))
        with self.assertRaisesRegex(ValueError, "a.lcm: not an LCM log, there is no event in it"):
            rumi.lcm.EventLog(self.path)

    def test_an_empty_file_is_a_log_without_events(self):
        self.assertEqual(self.read(b""), ([], 0, 0))


class Datagrams(unittest.TestCase):
    def setUp(self):
        self.assembler = datagrams.Assembler()

    def take(self, pieces, address="a"):
        return [m for piece in pieces if (m := self.assembler.take(address, piece))]

    def test_a_message_of_any_size_comes_together_in_any_order(self):
        chance = random.Random(2)
        for sequence, size in enumerate((0, 1, 65490, 65495, 65500, 200_000, 3_000_000)):
            data = chance.randbytes(size)
            pieces = datagrams.split(sequence, b"CHANNEL", data)
            self.assertTrue(all(len(piece) <= 65507 for piece in pieces))
            chance.shuffle(pieces)
            self.assertEqual(self.take(pieces), [("CHANNEL", data)])
        self.assertEqual((self.assembler.lost, self.assembler.not_lcm), (0, 0))

    def test_senders_do_not_mix(self):
        a, b = (datagrams.split(0, b"C", bytes([i]) * 100_000) for i in (1, 2))
        self.assertEqual(self.take([a[0]], "a") + self.take([b[0]], "b") + self.take([b[1]], "b") + self.take([a[1]], "a"),
                         [("C", b"\2" * 100_000), ("C", b"\1" * 100_000)])

    def test_a_lost_piece_loses_its_message_alone(self):
        first, second = (datagrams.split(i, b"C", bytes(200_000)) for i in range(2))
        self.assertEqual(len(self.take(first[:1] + first[2:] + second)), 1)
        self.assertEqual(self.assembler.lost, 1)

    def test_messages_that_never_came_are_counted(self):
        self.take(datagrams.split(2**32 - 2, b"C", b"") + datagrams.split(2**32 + 3, b"C", b""))
        self.assertEqual(self.assembler.lost, 4)
        self.take(datagrams.split(7, b"C", b""), "who begins to be heard")
        self.assertEqual(self.assembler.lost, 4)

    def test_pieces_that_come_twice_or_late_do_no_harm(self):
        first, second = (datagrams.split(i, b"C", bytes(200_000)) for i in range(2))
        self.assertEqual(len(self.take(first + second[:2] + first[:2] + second[1:] + second[:1])), 2)
        self.assertEqual(self.assembler.lost, 0)

    def test_a_sender_that_was_started_again_is_heard_at_once(self):
        self.take(datagrams.split(5000, b"C", bytes(200_000))[:1])
        self.assertEqual(len(self.take(datagrams.split(0, b"C", bytes(200_000)))), 1)
        self.assertEqual(self.assembler.lost, 1)

    def test_garbage_is_counted(self):
        chance = random.Random(3)
        long_piece = datagrams.split(0, b"C", bytes(100_000))[0]
        garbage = [b"", b"x", b"LC02", b"LC03", b"LC02" + bytes(4) + b"no end of a name" * 10, b"LC02" + bytes(5), long_piece[:20], b"LC03" + b"\xff" * 40]
        self.assertEqual(self.take(garbage), [])
        self.assertEqual(self.assembler.not_lcm, len(garbage))
        for _ in range(20_000):
            header = struct.pack(">IIIIHH", 0x4C433033, *(chance.choice((0, 1, 2, 3, 2**16 - 1)) for _ in range(5)))
            self.assembler.take(chance.randrange(5), header + chance.randbytes(chance.randrange(9)) + b"\0")

    def test_messages_in_part_are_held_within_bounds(self):
        piece = struct.pack(">IIIIHH", 0x4C433033, 0, 2**32 - 1, 0, 1, 65535) + bytes(60_000)
        for address in range(5000):
            self.assembler.take(address, piece)
        self.assertLessEqual(self.assembler._held, 2**28)
        self.assertLessEqual(len(self.assembler._senders), 1000)
        self.assertEqual(self.assembler.lost, 4000)

    def test_names_that_lcm_cannot_carry_are_refused(self):
        for name in (b"", b"a\0b", b"x" * 64):
            with self.assertRaisesRegex(ValueError, "1 to 63 bytes"):
                datagrams.split(0, name, b"")


class Urls(unittest.TestCase):
    def test_rumis_bus_is_that_of_its_programs(self):
        self.assertEqual(subprocess.run([PEER, "url"], capture_output=True, text=True, check=True).stdout.strip(), rumi.lcm.DEFAULT_URL)

    def test_what_cannot_be_a_bus_is_refused_with_a_reason(self):
        for url, reason in (("file:///tmp/a.lcm", "for a log: rumi.lcm.EventLog"), ("tcpq://localhost", "not the URL of a multicast bus"),
                            ("239.255.76.67:7667", "not the URL of a multicast bus"), ("udpm://10.0.0.1:7667", "10.0.0.1 is not a multicast address"),
                            ("udpm://robot:7667", "robot is not a multicast address"), ("udpm://239.255.76.67:99999", "the port is '99999'"),
                            ("udpm://239.255.76.67:7667?ttl=-1", "ttl is '-1', not a number from 0 to 255"), ("udpm://?ttl=", "ttl is ''")):
            with self.assertRaisesRegex(ValueError, reason):
                rumi.lcm.LCM(url)


if __name__ == "__main__":
    unittest.main()
