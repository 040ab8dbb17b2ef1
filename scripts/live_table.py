# SPDX-License-Identifier: BSD-3-Clause
"""Table of what scripts/live_table.sh measured: python3 live_table.py OUT RECORDING ..."""
import csv
import json
import pathlib
import statistics
import sys

# heading, key, digits, is more better
COLUMNS = [("in the map", "in_map", 3, True), ("ATE m", "ate_m", 4, False), ("true_rate", "true_rate", 3, True),
           ("in any submap", "in_submaps", 3, True), ("front submaps", "front_submaps", 0, False),
           ("largest front submap", "largest", 3, True), ("its ATE m", "largest_ate_m", 4, False),
           ("worst front submap in the map, ATE m", "worst_in_map_m", 4, False),
           ("latency p50 ms", "latency_p50_ms", 1, False), ("p95 ms", "latency_p95_ms", 1, False),
           ("images not answered", "unanswered", 3, False), ("front_tracker MB", "front_mb", 0, False)]


def measure(folder):
    evaluation = json.loads((folder / "evaluation.json").read_text())
    seen = json.loads((folder / "live_stats.json").read_text())
    front = [s for s in evaluation["per_submap"] if not s["name"].startswith("b")]
    in_map = [s["ate_in_map_rmse_m"] for s in front if s["ate_in_map_rmse_m"] is not None]
    largest = max(front, key=lambda s: s["frames"], default={"frames": 0, "ate_rmse_m": None})
    return {
        "run": folder.name,
        "in_map": evaluation["tracked_frame_ratio"],
        "ate_m": evaluation["ate_rmse_m"],
        "true_rate": evaluation["true_rate"],
        "in_submaps": evaluation["submap_frame_ratio"],
        "front_submaps": len(front),
        "largest": largest["frames"] / evaluation["frames"],
        "largest_ate_m": largest["ate_rmse_m"],
        "worst_in_map_m": max(in_map, default=None),
        "latency_p50_ms": seen["latency_p50_ms"],
        "latency_p95_ms": seen["latency_p95_ms"],
        "unanswered": 1 - seen["answers"] / evaluation["frames"],
        "front_mb": seen["peak_memory_mb"].get("front_tracker"),
    }


def cell(runs, key, digits, more_is_better):
    values = [r[key] for r in runs if r[key] is not None]
    if not values:
        return "–"
    worst = min(values) if more_is_better else max(values)
    return f"{statistics.median(values):.{digits}f} / {worst:.{digits}f}"


def main():
    out, recordings = pathlib.Path(sys.argv[1]), sys.argv[2:]
    everything = []
    print("| recording | runs | " + " | ".join(c[0] for c in COLUMNS) + " |")
    print("|---" * (len(COLUMNS) + 2) + "|")
    for recording in recordings:
        done = sorted(p.parent for p in out.glob(f"{recording}_[0-9]*/evaluation.json"))
        runs = [measure(folder) for folder in done]
        everything += runs
        print(f"| {recording} | {len(runs)} | " + " | ".join(cell(runs, *c[1:]) for c in COLUMNS) + " |")
    print("\nMedian / worst.")
    if everything:
        with open(out / "runs.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, everything[0].keys())
            writer.writeheader()
            writer.writerows(everything)


if __name__ == "__main__":
    main()
