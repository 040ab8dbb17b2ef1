# SPDX-License-Identifier: BSD-3-Clause
"""Tables of what scripts/back_process_table.sh measured: python3 back_process_table.py OUT"""
import csv
import json
import math
import pathlib
import statistics
import sys

from rendered_runs import WRONG_PERCENT, identity, spread, write_tables


def frames_with_pose(run):
    """Utimes of all frames, and of those that a front submap has a pose of."""
    with open(run / "front" / "frames.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {int(r["utime"]) for r in rows}, {int(r["utime"]) for r in rows if r["submap"] not in ("", "0")}


def back_utimes(run):
    """Of all frames that a back submap has a pose of."""
    utimes = set()
    for path in (run / "back").glob("*.txt"):
        for line in path.read_text().splitlines():
            if line and not line.startswith("#"):
                seconds, _, fraction = line.split()[0].partition(".")
                utimes.add(int(seconds) * 1000000 + int(fraction.ljust(6, "0")[:6]))
    return utimes


def measure(run):
    all_frames, front = frames_with_pose(run)
    evaluation = json.loads((run / "front" / "evaluation.json").read_text())
    record = json.loads((run / "front" / "run.json").read_text())
    windows = [json.loads(line) for line in (run / "back" / "windows.jsonl").read_text().splitlines()]
    built = [w for w in windows if w["built"] and w["ate_m"] is not None]
    submaps = [s for s in evaluation["per_submap"] if s["ate_rmse_m"] is not None]
    largest = max(submaps, key=lambda s: s["frames"], default=None)
    return identity(run) | {
        "frames": len(all_frames),
        "front_ratio": len(front) / len(all_frames),
        "both_ratio": len((front | back_utimes(run)) & all_frames) / len(all_frames),
        "front_submaps": evaluation["submaps"],
        "front_ate_m": largest["ate_rmse_m"] if largest else None,
        "front_cpu_s": record["cpu_ms_per_frame"]["front_tracker"] * record["images"] / 1000,
        "windows": len(windows),
        "built": len(built),
        "wrong": sum(w["ate_percent"] > WRONG_PERCENT for w in built),
        "gap_sampled": sum(w["gap"] for w in windows),
        "gap_registered": sum(w["registered_gap"] for w in windows if w["built"]),
        "back_ate_m": math.sqrt(statistics.fmean(w["ate_m"] ** 2 for w in built)) if built else None,
        "back_ate_percent": max((w["ate_percent"] for w in built), default=None),
        "back_wall_s": sum(w["wall_s"] for w in windows),
        "back_cpu_s": sum(w["cpu_s"] for w in windows),
        "failures": "; ".join(w["failure"] for w in windows if not w["built"]),
    }


def table_row(sequence, kind, runs):
    def of(key):
        return [r[key] for r in runs]

    return [
        sequence, kind, str(len(runs)),
        spread(of("front_ratio"), 100), spread(of("front_ate_m"), 100, 2), spread(of("front_cpu_s")),
        f"{sum(of('built'))}/{sum(of('windows'))}", str(sum(of("wrong"))),
        spread(of("both_ratio"), 100), f"{sum(of('gap_registered'))}/{sum(of('gap_sampled'))}",
        spread(of("back_ate_m"), 100, 2), spread([r["back_wall_s"] for r in runs if r["windows"]]),
        spread([r["back_cpu_s"] for r in runs if r["windows"]]),
    ]


COLUMNS = ["sequence", "passage", "runs", "front: frames %", "ATE cm", "CPU s", "windows built", "wrong",
           "with back: frames %", "gap frames", "back ATE cm", "back wall s", "back CPU s"]


def main():
    out = pathlib.Path(sys.argv[1])
    runs = [measure(f.parent.parent) for f in out.glob("*/back/windows.jsonl")]
    if not runs:
        sys.exit(f"{out}: nothing measured")
    write_tables(runs, COLUMNS, table_row, out / "runs.csv", out / "table.csv")


if __name__ == "__main__":
    main()
