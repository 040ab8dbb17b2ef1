# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/thinning_table.sh measured: python3 thinning_table.py OUT

False are the frames in the map that are farther from the truth, after alignment, than 3 % of the true path. A path that
goes to and fro is long, and 3 % of it may be a large part of the room. So the error is also told in percent of the
spread: the RMS distance of the true positions of the frames in the map from their middle. At 100 % the map says nothing.
"""
import bisect
import csv
import json
import math
import pathlib
import re
import sys

from rendered_runs import write_table

WAYS = {"ours": "Rumi", "sequential": "COLMAP, sequential", "exhaustive": "COLMAP, exhaustive"}
COLUMNS = ["recording", "every", "images", "by", "in the map", "false", "ATE m", "ATE % of the path", "% of the spread", "CPU s", "said"]
MAX_TIME_DIFFERENCE_S = .02


def read_json(path):
    return json.loads(path.read_text()) if path.exists() and path.stat().st_size else {}


def children_cpu_s(times):
    """Of what the shell's `times` prints: its own time, then that of its children, user and system."""
    return sum(60 * int(m) + float(s) for m, s in re.findall(r"(\d+)m([\d.]+)s", times.splitlines()[1]))


def frames_in_map(frames_csv):
    if not frames_csv.exists():
        return 0
    with open(frames_csv, newline="") as file:
        return sum(f["in_map"] == "1" for f in csv.DictReader(file))


def cost(folder, way):
    """CPU seconds, and what the run said."""
    if way == "ours":
        code = (folder / "exit_code").read_text().strip()
        return children_cpu_s((folder / "times").read_text()), "" if code == "0" else f"exit code {code}"
    record = read_json(folder / "run" / "colmap.json")
    return record["cpu_s"], record["said"]


def positions(trajectory):
    """(time, x, y, z) of each pose of a TUM file, in order."""
    lines = [line.split() for line in trajectory.read_text().splitlines() if line and not line.startswith("#")]
    return sorted(tuple(float(v) for v in line[:4]) for line in lines)


def spread(trajectory, truth):
    """Of the true positions at the times of the trajectory. None if there are none."""
    true, found = positions(truth), []
    for time, *_ in positions(trajectory):
        i = bisect.bisect_left(true, (time,))
        nearest = min(true[max(0, i - 1):i + 1], key=lambda p: abs(p[0] - time))
        if abs(nearest[0] - time) <= MAX_TIME_DIFFERENCE_S:
            found.append(nearest[1:])
    if not found:
        return None
    middle = [sum(axis) / len(found) for axis in zip(*found)]
    return math.sqrt(sum(math.dist(p, middle) ** 2 for p in found) / len(found))


def percent(value, whole):
    return None if value is None or not whole else 100 * value / whole


def errors(folder):
    """False frames, ATE in metres, in % of the true path and of the spread. None where they are not known."""
    evaluation = read_json(folder / "evaluation.json")
    ate_m, true_rate = evaluation.get("ate_rmse_m"), evaluation.get("true_rate")
    path_m = float((folder / "true_path").read_text()) if (folder / "true_path").exists() else 0
    near = None if true_rate is None else round(true_rate * evaluation["images_with_truth"])
    truth = next((t for t in (folder.parent / "recording" / f"{name}.txt" for name in ("groundtruth", "colmap"))
                  if t.exists()), None)
    spread_m = spread(folder / "run" / "trajectory.txt", truth) if truth and ate_m is not None else None
    return {"false": None if near is None or ate_m is None else evaluation["frames_with_truth"] - near, "ate_m": ate_m,
            "of_path": percent(ate_m, path_m), "of_spread": percent(ate_m, spread_m)}


def text(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def row(cell, way):
    """None if there is nothing to tell."""
    folder = cell / way
    head = [cell.parent.name, cell.name, (cell / "images").read_text().strip(), WAYS[way]]
    if (folder / "skipped").exists():
        return [*head, "-", "-", "-", "-", "-", "-", (folder / "skipped").read_text().strip()]
    if not (folder / "done").exists():
        return None
    cpu_s, said = cost(folder, way)
    e = errors(folder)
    return [*head, str(frames_in_map(folder / "run" / "frames.csv")), text(e["false"], 0), text(e["ate_m"], 3),
            text(e["of_path"], 2), text(e["of_spread"], 1), text(cpu_s, 0), said]


def main():
    out = pathlib.Path(sys.argv[1])
    cells = [c.parent for c in out.glob("*/*/images")]
    cells.sort(key=lambda c: (c.parent.name, int(c.name)))
    rows = [r for r in (row(cell, way) for cell in cells for way in WAYS) if r]
    if not rows:
        sys.exit(f"{out}: nothing measured")
    write_table(out / "table.csv", COLUMNS, rows)


if __name__ == "__main__":
    main()
