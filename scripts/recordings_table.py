# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/recordings_table.sh measured: python3 recordings_table.py OUT"""
import csv
import json
import pathlib
import statistics
import sys

from rendered_runs import write_csv, write_table

COLUMNS = ["recording", "runs", "in the map", "when they came", "true", "ATE m", "ATE % of the path", "submaps",
           "first pose s", "CPU ms/frame", "of it front", "peak MB"]


def read_json(path):
    return json.loads(path.read_text()) if path.exists() else {}


def measure(run):
    """run: OUT/NAME/SEED. Nothing where the program did not end as it should."""
    record = read_json(run / "run" / "run.json")
    if not record.get("finished"):
        return None
    with open(run / "run" / "frames.csv", newline="") as file:
        frames = list(csv.DictReader(file))
    live = [f for f in frames if f["state"] == "TRACKING" and f["submap"] not in ("", "0")]
    evaluation = read_json(run / "evaluation.json")
    is_metric = (run / "truth").exists() and (run / "truth").read_text().strip() == "groundtruth"
    ate_m, path_m = evaluation.get("ate_rmse_m"), evaluation.get("path_m")
    cpu_ms = record["cpu_ms_per_frame"]
    return {
        "recording": run.parent.name,
        "seed": int(run.name),
        "frames": len(frames),
        "in_map": sum(f["in_map"] == "1" for f in frames) / max(1, len(frames)),
        "live": len(live) / max(1, len(frames)),
        "true": evaluation.get("true_rate") if is_metric else None,
        "ate_m": ate_m if is_metric else None,
        "ate_percent": 100 * ate_m / path_m if ate_m is not None and path_m else None,
        "submaps": record["counts"]["submaps"],
        "first_pose_s": (int(live[0]["utime"]) - int(frames[0]["utime"])) * 1e-6 if live else None,
        "cpu_ms": sum(cpu_ms.values()),
        "front_ms": cpu_ms["front_tracker"],
        "peak_mb": record["peak_rss_mb"],
    }


def read_runs(out):
    """All that OUT has of runs that ended as they should."""
    return [r for r in map(measure, sorted(p for p in out.glob("*/*") if p.name.isdigit())) if r]


def cell(values, worst, digits):
    """Median / worst of those that are known."""
    values = [v for v in values if v is not None]
    if not values:
        return "-"
    middle = f"{statistics.median(values):.{digits}f}"
    return f"{middle} / {worst(values):.{digits}f}" if len(values) > 1 else middle


def table_row(name, runs):
    def of(key, worst, digits):
        return cell([r[key] for r in runs], worst, digits)

    return [name, str(len(runs)), of("in_map", min, 3), of("live", min, 3), of("true", min, 3), of("ate_m", max, 4),
            of("ate_percent", max, 2), of("submaps", max, 0), of("first_pose_s", max, 2), of("cpu_ms", max, 1),
            of("front_ms", max, 1), of("peak_mb", max, 0)]


def main():
    out = pathlib.Path(sys.argv[1])
    runs = read_runs(out)
    if not runs:
        sys.exit(f"{out}: nothing measured")
    write_csv(out / "runs.csv", list(runs[0]), [list(r.values()) for r in runs])
    names = dict.fromkeys(r["recording"] for r in runs)
    rows = [table_row(name, [r for r in runs if r["recording"] == name]) for name in names]
    for kind in ("rendered", "passages"):
        of_kind = [r for r in runs if r["recording"].startswith(kind + "_")]
        if of_kind:
            rows.append(table_row(f"all {kind}", of_kind))
    write_table(out / "table.csv", COLUMNS, rows)


if __name__ == "__main__":
    main()
