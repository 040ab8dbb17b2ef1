# SPDX-License-Identifier: BSD-3-Clause
"""scripts/derived_recording.py: derived_recording_test.py SOURCE_DIR"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(sys.argv.pop(1)) / "scripts/derived_recording.py"


class Derived(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.source, self.out = (pathlib.Path(self.folder.name) / name for name in ("source", "out"))
        (self.source / "rgb").mkdir(parents=True)
        (self.source / "calibration.yaml").write_text("width: 640\n")
        (self.source / "rgb.txt").write_text("# timestamp filename\n" + "".join(f"{10 + i}.5 rgb/{i}.png\n" for i in range(5)))
        (self.source / "groundtruth.txt").write_text("10.5 1 0 0 0 0 0 1\n13.75 2 0 0 0 0 0 1\n")

    def derive(self, *arguments):
        return subprocess.run([sys.executable, "-B", SCRIPT, self.source, self.out, *arguments], capture_output=True, text=True)

    def test_backwards(self):
        self.assertEqual(self.derive("--backwards").returncode, 0)
        self.assertEqual((self.out / "rgb.txt").read_text().split()[:4], ["10.500000", "rgb/4.png", "11.500000", "rgb/3.png"])
        # What was true of a picture still is.
        self.assertEqual((self.out / "groundtruth.txt").read_text().split()[0::8], ["11.250000", "14.500000"])
        self.assertEqual((self.out / "groundtruth.txt").read_text().split()[1::8], ["2", "1"])

    def test_every_second(self):
        self.assertEqual(self.derive("--every", "2").returncode, 0)
        self.assertEqual((self.out / "rgb.txt").read_text().split()[1::2], ["rgb/0.png", "rgb/2.png", "rgb/4.png"])
        self.assertEqual((self.out / "calibration.yaml").read_text(), "width: 640\n")
        self.assertEqual(self.derive("--every", "2").returncode, 0, "again")

    def test_to_and_fro(self):
        self.assertEqual(self.derive("--passes", "3").returncode, 0)
        rows = [line.split() for line in (self.out / "rgb.txt").read_text().splitlines()]
        self.assertEqual([name[4] for t, name in rows], [*"012344321001234"])
        self.assertEqual([float(t) for t, name in rows], [10.5 + i for i in range(15)])
        truth = [line.split()[:2] for line in (self.out / "groundtruth.txt").read_text().splitlines()]
        self.assertEqual([x for t, x in truth], ["1", "2", "2", "1", "1", "2"])
        self.assertEqual(truth[3], ["19.500000", "1"], "of the image at 19.5 s, which is the first one")

    def test_bad_input(self):
        self.assertIn("--passes is 0", self.derive("--passes", "0").stderr)
        self.assertIn("--every is 0", self.derive("--every", "0").stderr)
        (self.source / "rgb.txt").write_text("# nothing\n")
        self.assertIn("rgb.txt: no images", self.derive().stderr)


if __name__ == "__main__":
    unittest.main()
