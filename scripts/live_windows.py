# SPDX-License-Identifier: BSD-3-Clause
"""What ruminator did in live runs, from their logs: python3 live_windows.py OUT RECORDING ..., a Markdown table of OUT/RECORDING_*.log"""
import pathlib
import re
import statistics
import sys

DONE = re.compile(r"ruminator info window (\d+): \d+ of \d+ \+ (\d+) of (\d+) \+ \d+ of \d+ images rebuilt in "
                  r"([\d.]+) s \(([\d.]+) s CPU\).*: map_server has it as submap -\d+(?:, ([\d.]+) s after tracking resumed)?")
FAILED = re.compile(r"ruminator warning window \d+: .*: failed(?: after [\d.]+ s)?: ")


def cell(values):
    if not values:
        return "–"
    values = sorted(values)
    return f"{statistics.median(values):.1f}, {values[int(0.95 * (len(values) - 1))]:.1f}, {values[-1]:.1f}"


def main():
    out, recordings = pathlib.Path(sys.argv[1]), sys.argv[2:]
    print("| recording | runs | windows | published | failed | frames of the gaps registered | wall s | CPU s "
          "| published, s after tracking resumed |")
    print("|---" * 9 + "|")
    for recording in recordings:
        texts = [p.read_text(errors="replace") for p in sorted(out.glob(f"{recording}_[0-9]*.log"))]
        text = "\n".join(texts)
        done, failed = DONE.findall(text), FAILED.findall(text)
        registered, of = sum(int(d[1]) for d in done), sum(int(d[2]) for d in done)
        print(f"| {recording} | {len(texts)} | {len(done) + len(failed)} | {len(done)} | {len(failed)} "
              f"| {registered} of {of} | {cell([float(d[3]) for d in done])} | {cell([float(d[4]) for d in done])} "
              f"| {cell([float(d[5]) for d in done if d[5]])} |")
    print("\nTimes: median, 95 %, longest.")


if __name__ == "__main__":
    main()
