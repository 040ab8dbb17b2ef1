# SPDX-License-Identifier: BSD-3-Clause
"""What ruminator did in live runs, from their logs: python3 live_windows.py OUT RECORDING ..., a Markdown table of OUT/RECORDING_*.log"""
import pathlib
import re
import statistics
import sys

BUILT = re.compile(r"ruminator info window (\d+): \d+ of \d+ \+ (\d+) of (\d+) \+ \d+ of \d+ frames registered, "
                   r".* ([\d.]+) s \(([\d.]+) s CPU\)")
PUBLISHED = re.compile(r"ruminator info window (\d+): published, .* ([\d.]+) s after tracking resumed")
QUEUED = re.compile(r"ruminator info window \d+: .* frames between .*queued")
FAILED = re.compile(r"ruminator warning window \d+: failed")


def cell(values):
    if not values:
        return "–"
    values = sorted(values)
    return f"{statistics.median(values):.1f}, {values[int(0.95 * (len(values) - 1))]:.1f}, {values[-1]:.1f}"


def main():
    out, recordings = pathlib.Path(sys.argv[1]), sys.argv[2:]
    print("| recording | runs | windows queued | published | failed | frames of the gaps registered | wall s | CPU s "
          "| published, s after tracking resumed |")
    print("|---" * 9 + "|")
    for recording in recordings:
        texts = [p.read_text(errors="replace") for p in sorted(out.glob(f"{recording}_[0-9]*.log"))]
        text = "\n".join(texts)
        built, published = BUILT.findall(text), PUBLISHED.findall(text)
        registered, of = sum(int(b[1]) for b in built), sum(int(b[2]) for b in built)
        print(f"| {recording} | {len(texts)} | {len(QUEUED.findall(text))} | {len(published)} | {len(FAILED.findall(text))} "
              f"| {registered} of {of} | {cell([float(b[3]) for b in built])} | {cell([float(b[4]) for b in built])} "
              f"| {cell([float(p[1]) for p in published])} |")
    print("\nTimes: median, 95 %, longest.")


if __name__ == "__main__":
    main()
