#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Does it last? The whole system live (scripts/live_run.sh) on a recording that is played again and again at its own pace:
# what was seen from outside (losses), then Markdown tables: how long each stage took, and the memory and CPU time of each
# process as time goes by, and of the map on disk. MB an hour: of the line through all minutes after the first half hour.
#   scripts/long_run.sh BUILD_DIR INPUT OUT MINUTES [flags of scripts/live_run.sh, instead of --loop ...]
# OUT must not exist; the log is OUT.log. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1
input=$2
out=$3
minutes=$4
shift 4
[ $# -gt 0 ] || set -- --loop
if [ -e "$out" ]; then
  echo "$out exists: name a new folder" >&2
  exit 1
fi
code=0
RUMI_LIVE_MINUTES=$minutes "$here/live_run.sh" "$build" "$input" "$out" "$@" >"$out.log" 2>&1 || code=$?
grep 'seen from outside' "$out.log" || tail -n 20 "$out.log"
python3 - "$out" <<'PYTHON'
import csv, json, pathlib, sys
out = pathlib.Path(sys.argv[1])
if (out / "live_stats.json").exists():
    print("\n| stage, ms | p50 | p95 | p99 | max | of |\n|---|---|---|---|---|---|")
    for name, s in json.loads((out / "live_stats.json").read_text())["stages_ms"].items():
        if s["n"]:
            print(f"| {name} | {s['p50']:.1f} | {s['p95']:.1f} | {s['p99']:.1f} | {s['max']:.0f} | {s['n']} |")
    print()
rows = {}
for minute, name, rss, peak, cpu in csv.reader(open(out / "load.csv")):
    rows.setdefault(name, []).append((int(minute), float(rss), float(peak or 0), float(cpu or 0)))
some = lambda r: sorted({0, len(r) // 4, len(r) // 2, len(r) - 1})
first = next(iter(rows.values()))
# Of the line through what it was after the first half hour, where there are some minutes of that.
def mb_an_hour(r):
    late = [(minute / 60, mb) for minute, mb, _, _ in r if minute >= 30]
    if len(late) < 5:
        return "–"
    mean = [sum(v) / len(late) for v in zip(*late)]
    slope = sum((h - mean[0]) * (mb - mean[1]) for h, mb in late) / sum((h - mean[0]) ** 2 for h, _ in late)
    return f"{slope:.1f}"
print("| process |", " | ".join(f"MB at {first[i][0]} min" for i in some(first)), "| MB an hour | peak MB | CPU % |")
print("|---" * (len(some(first)) + 4) + "|")
for name, r in rows.items():
    load = f"{100 * r[-1][3] / (60 * r[-1][0]):.0f}" if r[-1][3] else ""
    print(f"| {name} |", " | ".join(f"{r[i][1]:.0f}" for i in some(r)), f"| {mb_an_hour(r)} | {r[-1][2]:.0f} | {load} |")
PYTHON
exit "$code"
