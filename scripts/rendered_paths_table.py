# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/rendered_paths_table.sh measured: python3 rendered_paths_table.py OUT"""
import json
import pathlib
import statistics
import sys

from rendered_runs import write_table

# An error beyond this share of the true path: the submap has diverged.
DIVERGED_PERCENT = 5.0
COLUMNS = ["sequence", "kind", "frames", "in any submap %", "tracked %", "true_rate %", "submaps", "diverged",
           "ATE cm (% of path) of each submap", "CPU ms/frame"]


def measure(evaluation_json):
    evaluation = json.loads(evaluation_json.read_text())
    sequence, kind = evaluation_json.parent.name.rsplit("_", 1)
    submaps = [(s["ate_rmse_m"], s["path_m"]) for s in evaluation["per_submap"] if s["ate_rmse_m"] is not None]
    return {
        "sequence": sequence,
        "kind": kind,
        "frames": evaluation["frames"],
        "submap_frame_ratio": evaluation["submap_frame_ratio"],
        "tracked_frame_ratio": evaluation["tracked_frame_ratio"],
        "true_rate": evaluation["true_rate"] or 0.0,
        "submaps": evaluation["submaps"],
        "diverged": sum(100 * ate > DIVERGED_PERCENT * path for ate, path in submaps),
        "each": " ".join(f"{100 * ate:.1f} ({100 * ate / path:.1f})" for ate, path in submaps),
        "cpu_ms": evaluation["cpu_ms_per_frame"]["front_tracker"],
    }


def table_row(r):
    return [r["sequence"], r["kind"], str(r["frames"]), f"{100 * r['submap_frame_ratio']:.1f}",
            f"{100 * r['tracked_frame_ratio']:.1f}", f"{100 * r['true_rate']:.1f}", str(r["submaps"]),
            str(r["diverged"]), r["each"], f"{r['cpu_ms']:.1f}"]


def summary(kind, runs):
    together = {key: sum(r[key] for r in runs) for key in ("frames", "submaps", "diverged")}
    means = {key: statistics.fmean(r[key] for r in runs)
             for key in ("submap_frame_ratio", "tracked_frame_ratio", "true_rate", "cpu_ms")}
    return {"sequence": "all", "kind": kind, "each": "", **together, **means}


def main():
    out = pathlib.Path(sys.argv[1])
    runs = [measure(f) for f in sorted(out.glob("*/evaluation.json"))]
    if not runs:
        sys.exit(f"{out}: nothing measured")
    rows = []
    for kind in sorted({r["kind"] for r in runs}, reverse=True):
        of_kind = [r for r in runs if r["kind"] == kind]
        rows += [table_row(r) for r in of_kind + [summary(kind, of_kind)]]
    write_table(out / "table.csv", COLUMNS, rows)


if __name__ == "__main__":
    main()
