# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/merge_table.sh measured: python3 merge_table.py OUT"""
import json
import math
import pathlib
import sqlite3
import sys

from rendered_runs import WRONG_PERCENT, identity, spread, write_tables

WAYS = ["front", "kept", "culled"]
FIGURES = ["span_rate", "tracked_frame_ratio", "true_rate", "ate_rmse_m"]


def true_path_m(file):
    centers = [tuple(map(float, line.split()[1:4])) for line in file.read_text().splitlines()
               if line and not line.startswith("#")]
    return sum(math.dist(a, b) for a, b in zip(centers, centers[1:]))


def of_map(file):
    """Keyframes and back submaps of the served map."""
    with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as db:
        keyframes, = db.execute("SELECT count(*) FROM keyframes JOIN submaps USING (submap) WHERE in_map").fetchone()
        back, = db.execute("SELECT count(*) FROM submaps WHERE in_map AND kind = 1").fetchone()
    return {"keyframes": keyframes, "back_submaps": back, "bytes": file.stat().st_size}


def measure(run):
    """One row: a rendering, replayed in every way."""
    path_m = true_path_m(run / "sequence" / "groundtruth.txt")
    row = identity(run) | {"path_m": path_m}
    for way in WAYS:
        evaluation = json.loads((run / way / "evaluation.json").read_text())
        figures = {key: evaluation[key] for key in FIGURES} | of_map(run / way / "map.db")
        ate = figures["ate_rmse_m"]
        figures["wrong"] = ate is not None and 100 * ate > WRONG_PERCENT * path_m
        row |= {f"{way}_{key}": value for key, value in figures.items()}
    return row


def table_row(sequence, kind, runs):
    row = [sequence, kind, str(len(runs))]
    for way in WAYS:
        def of(key):
            return [r[f"{way}_{key}"] for r in runs]

        row += [spread(of("span_rate"), 100), spread(of("tracked_frame_ratio"), 100), spread(of("true_rate"), 100),
                spread(of("ate_rmse_m"), 100), spread(of("keyframes"), 1, 0), str(sum(of("wrong")))]
    return row


COLUMNS = ["sequence", "passage", "runs"] + [
    f"{way}: {column}" for way in ("front alone", "one map", "post-culled")
    for column in ("rate %", "frames %", "true %", "RMSE cm", "keyframes", "wrong")]


def main():
    out = pathlib.Path(sys.argv[1])
    # `kept` is measured last.
    runs = [measure(f.parent.parent) for f in out.glob("*/kept/evaluation.json")]
    if not runs:
        sys.exit(f"{out}: nothing measured")
    write_tables(runs, COLUMNS, table_row, out / "merge_runs.csv", out / "merge_table.csv")


if __name__ == "__main__":
    main()
