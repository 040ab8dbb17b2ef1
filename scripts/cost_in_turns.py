# SPDX-License-Identifier: BSD-3-Clause
"""What the whole system costs now and before, in turns, so that both meet the same machine: a Markdown table of the CPU
ms a frame of each component, median of the runs, and their ratio to cv::ORB(1000) on the same images in the same turns.
    python3 cost_in_turns.py BUILD_BEFORE BUILD_NOW OUT RUNS RECORDING ...
BUILD_NOW has its benchmarks built (RUMI_BENCH=ON)."""
import json
import pathlib
import re
import statistics
import subprocess
import sys

COMPONENTS = ["front_tracker", "map_server", "ruminator", "viewer_offscreen"]


def replay(build, recording, out):
    done = subprocess.run([f"{build}/bin/rumi", "replay", recording, "-o", out, "-q"],
                          stdout=subprocess.DEVNULL)
    if done.returncode not in (0, 3):  # 3: not with all of the images
        sys.exit(f"{build}/bin/rumi replay {recording}: exit code {done.returncode}")
    run = json.loads((out / "run.json").read_text())
    return {"all": sum(run["cpu_ms_per_frame"].values()), "MB": run["peak_rss_mb"], **run["cpu_ms_per_frame"]}


def orb_ms(build, recording):
    said = subprocess.run([f"{build}/bench/sequence_bench", recording, "--orb"], capture_output=True, text=True, check=True)
    return float(re.search(r"cv::ORB\(1000\) ([0-9.]+) ms", said.stdout).group(1))


def main():
    before, now, out, runs = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), int(sys.argv[4])
    out.mkdir(parents=True, exist_ok=True)
    columns = ["all", *COMPONENTS, "MB"]
    print("| recording | " + " | ".join(columns) + " | cv::ORB(1000) | all / ORB |\n|---|" + "---|" * (len(columns) + 2))
    for recording in sys.argv[5:]:
        name = pathlib.Path(recording).name
        turns = [(replay(before, recording, out / "before" / name), replay(now, recording, out / "now" / name),
                  orb_ms(now, recording)) for _ in range(runs)]
        (out / f"{name}.json").write_text(json.dumps(turns, indent=1))
        orb = statistics.median(t[2] for t in turns)
        middle = [{c: statistics.median(t[i].get(c, 0) for t in turns) for c in columns} for i in (0, 1)]
        cells = [f"{middle[0][c]:.1f} → {middle[1][c]:.1f}" for c in columns]
        ratio = " → ".join(f"{m['all'] / orb:.1f}" for m in middle)
        print(f"| {name} | " + " | ".join(cells) + f" | {orb:.1f} | {ratio} |", flush=True)


if __name__ == "__main__":
    main()
