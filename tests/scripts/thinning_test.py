# SPDX-License-Identifier: BSD-3-Clause
"""scripts/thinning_table.sh and colmap_run.py: thinning_test.py SOURCE_DIR"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(sys.argv.pop(1)) / "scripts"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPTS))
import colmap_run  # noqa: E402


def pretend(run, in_map, evaluation=None):
    """A measured run of 40 frames on a path of 10 m, as thinning_table.sh leaves it."""
    (run / "run").mkdir(parents=True)
    (run / "done").touch()
    frames = [f"{i},TRACKING,1,{int(i < in_map)}" for i in range(40)]
    (run / "run" / "frames.csv").write_text("\n".join(["utime,state,submap,in_map", *frames]) + "\n")
    if evaluation:
        (run / "true_path").write_text("10\n")
        (run / "run" / "trajectory.txt").write_text("".join(f"{t} 0 0 0 0 0 0 1\n" for t in (1, 2, 3)))
        (run / "evaluation.json").write_text(json.dumps(evaluation))
    return run


class Table(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = pathlib.Path(folder.name)

    def rows(self):
        done = subprocess.run([SCRIPTS / "thinning_table.sh", "nowhere", "nowhere", self.out],
                              env=os.environ | {"RUMI_TABLE_ONLY": "1"}, capture_output=True, text=True)
        self.error = done.stderr
        return [line.strip("| ").split(" | ") for line in done.stdout.splitlines()[2:]]

    def test_a_row_for_each_way(self):
        cell = self.out / "stairs" / "4"
        evaluation = {"ate_rmse_m": .2, "true_rate": .75, "images_with_truth": 40, "frames_with_truth": 36}
        ours = pretend(cell / "ours", 36, evaluation)
        (ours / "times").write_text("0m0.010000s 0m0.000000s\n1m2.500000s 0m1.500000s\n")
        (ours / "exit_code").write_text("3\n")
        colmap = pretend(cell / "sequential", 40)
        (colmap / "run" / "colmap.json").write_text('{"cpu_s": 90.2, "said": "more than 90 CPU s"}')
        (cell / "exhaustive").mkdir()
        (cell / "exhaustive" / "skipped").write_text("more than 30 images\n")
        (cell / "images").write_text("40\n")
        # The frames in the map are at -2, 0 and 2: a spread of sqrt(8 / 3). The truth has more, at other times.
        (cell / "recording").mkdir()
        (cell / "recording" / "groundtruth.txt").write_text(
            "# truth\n.5 9 9 9 0 0 0 1\n1.01 -2 5 0 0 0 0 1\n2 0 5 0 0 0 0 1\n2.99 2 5 0 0 0 0 1\n4 9 9 9 0 0 0 1\n")
        self.assertEqual(self.rows(), [
            ["stairs", "4", "40", "Rumi", "36", "6", "0.200", "2.00", "12.2", "64", "exit code 3"],
            ["stairs", "4", "40", "COLMAP, sequential", "40", "-", "-", "-", "-", "90", "more than 90 CPU s"],
            ["stairs", "4", "40", "COLMAP, exhaustive", "-", "-", "-", "-", "-", "-", "more than 30 images"]])

    def test_what_is_not_done_has_no_row(self):
        (self.out / "stairs" / "4" / "ours").mkdir(parents=True)
        (self.out / "stairs" / "4" / "images").write_text("40\n")
        self.assertEqual(self.rows(), [])
        self.assertIn("nothing measured", self.error)


class Colmap(unittest.TestCase):
    def test_its_poses_are_turned_round(self):
        # A quarter turn about z, and a camera that is at (2, -1, 3): the images are not in the order of time.
        images = ("# comment\n1 0.70710678 0 0 0.70710678 -1 -2 -3 1 rgb/b.png\n1 2 3\n"
                  "2 1 0 0 0 -4 -5 -6 1 rgb/a.png\n\n")
        lines = [[float(v) for v in line.split()]
                 for line in colmap_run.trajectory(images, {"rgb/a.png": "1.5", "rgb/b.png": "2.5"}).splitlines()]
        for line, expected in zip(lines, [[1.5, 4, 5, 6, 0, 0, 0, 1], [2.5, 2, -1, 3, 0, 0, -.70710678, .70710678]]):
            for value, right in zip(line, expected):
                self.assertAlmostEqual(value, right, 6)
        self.assertEqual(len(lines), 2)

    def test_cameras(self):
        text = "# fx: 1\nmodel: pinhole\nfx: 500\nfy: 501.5\ncx: 320\ncy: 240\n"
        self.assertEqual(colmap_run.camera_of(text + "k1: 0\n"), ("PINHOLE", [500, 501.5, 320.5, 240.5]))
        self.assertEqual(colmap_run.camera_of(text + "k1: 0.1\np2: -1e-3\n"),
                         ("OPENCV", [500, 501.5, 320.5, 240.5, .1, 0, 0, -.001]))
        self.assertEqual(colmap_run.camera_of(text + "k3: 2\n")[0], "FULL_OPENCV")
        with self.assertRaises(SystemExit):
            colmap_run.camera_of("model: fisheye\n")


if __name__ == "__main__":
    unittest.main()
