# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/disturbed_table.sh measured: python3 disturbed_table.py OUT

A run is good if its error is at most 1.3 times that of the recording as it is (or below .2 % of the path; without a truth:
below 1 % against the recording's own path) and it has .97 of its frames, honest if it ends with exit code 3 otherwise, and
else wrong."""
import pathlib
import sys

from disturbances import KINDS
from recordings_table import cell, read_runs
from rendered_runs import write_table

MOST_ERROR, LEAST_FRAMES, SMALL_PERCENT, OWN_PERCENT = 1.3, .97, .2, 1


def verdict(run, clean):
    lost = run["in_map"] < LEAST_FRAMES * clean["in_map"]
    error, plain = run["ate_percent"], clean["ate_percent"]
    most = OWN_PERCENT if plain is None else max(MOST_ERROR * plain, SMALL_PERCENT)
    wrong = error is not None and error > most
    if not lost and not wrong:
        return "good"
    return "honest" if run["exit_code"] != 0 else "wrong"


def main():
    out = pathlib.Path(sys.argv[1])
    runs = read_runs(out)
    for run in runs:
        run["exit_code"] = int((out / run["recording"] / str(run["seed"]) / "exit_code").read_text())
    plain = {(r["recording"], r["seed"]): r for r in runs}
    rows, counts = [], {}
    for kind in KINDS:
        for name in dict.fromkeys(r["recording"] for r in runs):
            if not name.startswith(kind + "_"):
                continue
            pairs = [(r, plain[(name[len(kind) + 1:], r["seed"])]) for r in runs if r["recording"] == name]
            verdicts = [verdict(r, clean) for r, clean in pairs]
            for v in verdicts:
                counts[v] = counts.get(v, 0) + 1

            rows.append([kind, name[len(kind) + 1:], cell([r["in_map"] for r, _ in pairs], min, 3),
                         cell([r["ate_percent"] for r, _ in pairs], max, 2),
                         " ".join(str(r["exit_code"]) for r, _ in pairs), " ".join(verdicts)])
    for name in dict.fromkeys(r["recording"] for r in runs if r["recording"].split("_")[0] not in KINDS):
        of = [r for r in runs if r["recording"] == name]
        rows.append(["as it is", name, cell([r["in_map"] for r in of], min, 3), cell([r["ate_percent"] for r in of], max, 2),
                     " ".join(str(r["exit_code"]) for r in of), ""])
    write_table(out / "disturbed.csv", ["disturbance", "recording", "in the map", "ATE % of the path", "exit codes", "runs"], rows)
    print("\n" + ", ".join(f"{n} {v}" for v, n in sorted(counts.items())))


if __name__ == "__main__":
    main()
