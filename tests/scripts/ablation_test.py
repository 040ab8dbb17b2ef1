# SPDX-License-Identifier: BSD-3-Clause
"""scripts/ablation.sh: which values it tries, and what it makes of runs that are there. ablation_test.py RUMI SOURCE_DIR"""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUMI, SOURCE = pathlib.Path(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1))
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts"))
import ablation  # noqa: E402


def pretend(run, in_map, ate_m, cpu_ms, finished=True):
    """A run of ten frames, as recordings_table.sh leaves it."""
    (run / "run").mkdir(parents=True)
    (run / "log").touch()
    (run / "truth").write_text("groundtruth\n")
    record = {"finished": finished, "cpu_ms_per_frame": {"front_tracker": cpu_ms}, "counts": {"submaps": 1},
              "peak_rss_mb": 100}
    (run / "run" / "run.json").write_text(json.dumps(record))
    frames = [f"{i},TRACKING,{int(i < 8)},{int(i < in_map)}" for i in range(10)]
    (run / "run" / "frames.csv").write_text("\n".join(["utime,state,submap,in_map", *frames]) + "\n")
    (run / "evaluation.json").write_text(json.dumps({"ate_rmse_m": ate_m, "path_m": 10, "true_rate": 1}))


class Settings(unittest.TestCase):
    def of(self, *keys):
        printed = subprocess.run([sys.executable, "-B", SOURCE / "scripts/ablation.py", "settings", RUMI, *keys],
                                 capture_output=True, text=True)
        return printed.stdout.split(), printed.stderr

    def test_halved_doubled_and_off(self):
        self.assertEqual(self.of("map_server.min_landmarks", "map_server.max_joint_chi2")[0], [
            "map_server.min_landmarks=20", "map_server.min_landmarks=80", "map_server.min_landmarks=3",
            "map_server.max_joint_chi2=50", "map_server.max_joint_chi2=200", "map_server.max_joint_chi2=1e+09"])

    def test_whole_numbers_stay_whole_and_in_their_range(self):
        self.assertEqual(self.of("ruminator.resection_min_inliers")[0], [
            f"ruminator.resection_min_inliers={value}" for value in ("8", "30", "6")])
        self.assertEqual(self.of("map_server.min_inlier_ratio")[0], [
            f"map_server.min_inlier_ratio={value}" for value in ("0.25", "1", "0")])

    def test_what_is_no_number_is_refused(self):
        self.assertIn("map_server.merge:", self.of("map_server.merge")[1])
        self.assertIn("map_server.landmarks:", self.of("map_server.landmarks")[1])

    def test_those_of_the_list_exist(self):
        settings, error = self.of()
        self.assertEqual(error, "")
        self.assertEqual({s.split("=")[0] for s in settings}, set(ablation.OPTIONS))


class Table(unittest.TestCase):
    def test_changes_beside_the_defaults(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            half = out / "map_server.min_landmarks=20"
            for name in ("kitchen", "street", "stairs"):
                pretend(out / "defaults" / name / "0", 8, 0.1, 10)
            pretend(half / "kitchen" / "0", 8, 0.1, 11)
            pretend(half / "street" / "0", 6, 0.15, 8)
            pretend(half / "stairs" / "0", 0, None, 8, finished=False)
            done = subprocess.run([SOURCE / "scripts/ablation.sh", RUMI.parent.parent, "nowhere", out,
                                   "map_server.min_landmarks"], env=os.environ | {"RUMI_TABLE_ONLY": "1"},
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("map_server.min_landmarks=80: nothing measured", done.stderr)
            self.assertIn("| map_server.min_landmarks | 20 | 2 | 1 | 1 |", done.stdout)
            with open(out / "ablation.csv", newline="") as file:
                rows = list(csv.reader(file))
        self.assertEqual(rows[0], ablation.COLUMNS)
        self.assertEqual(rows[1], ["map_server.min_landmarks", "20", "2", "1", "1", "-0.100 / -0.200", "0.000 / 0.000",
                                   "1.25 / 1.50", "0.95 / 1.10"])
        self.assertEqual(rows[2], ["map_server.min_landmarks", "80", "0", "0", "0", "-", "-", "-", "-"])


if __name__ == "__main__":
    unittest.main()
