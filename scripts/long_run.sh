#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Does it last? The five processes over LCM, in a network of their own, on a recording that is played again and again at
# its own pace: a Markdown table of the memory and CPU time of each process as time goes by, and of the map on disk, then
# what was seen from outside (latency, losses).
#   scripts/long_run.sh BUILD_DIR INPUT OUT MINUTES
# OUT/load.csv: minute,process,rss_mb,peak_mb,cpu_s (map.db: its size in MB). Needs python3.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
if [ "${RUMI_IN_NETNS:-}" != 1 ]; then
  exec "$here/tests/run_in_netns.sh" "$0" "$@"
fi
build=$1
input=$2
out=$3
minutes=$4
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'
mkdir -p "$out"
stats=""
up=""
cleanup() {
  for pid in $up $stats; do kill "$pid" 2>/dev/null || true; done
  wait
}
trap cleanup EXIT

"$build/tests/live_stats" -q --lcm-url "$url" >"$out/live_stats.json" &
stats=$!
"$build/bin/rumi" up "$here/config/rumi.yaml" "$input" --loop --lcm-url "$url" --set "map_server.database=$out/map.db" \
  --set "ruminator.spool=$out/spool" --set "viewer_offscreen.output=$out/pictures" --snapshot "$out/run" >"$out/log" 2>&1 &
up=$!

ticks=$(getconf CLK_TCK)
sample() { # MINUTE
  for pid in $(pgrep -P "$up"); do
    name=$(basename "$(tr '\0' '\n' <"/proc/$pid/cmdline" | head -n 1)") || continue
    cpu=$(awk -v t="$ticks" '{print ($14 + $15 + $16 + $17) / t}' "/proc/$pid/stat") || continue
    awk -v m="$1" -v n="$name" -v c="$cpu" '/^VmRSS/ {r = $2} /^VmHWM/ {h = $2}
      END {printf "%d,%s,%.1f,%.1f,%.1f\n", m, n, r * 1.024e-3, h * 1.024e-3, c}' "/proc/$pid/status"
  done
  du -cB1 "$out"/map.db* | awk -v m="$1" 'END {printf "%d,map.db,%.1f,,\n", m, $1 * 1e-6}'
}
for minute in $(seq "$minutes"); do
  sleep 60
  kill -0 "$up" 2>/dev/null || break
  sample "$minute" >>"$out/load.csv"
done
kill -INT "$up"
code=0
wait "$up" || code=$?
up=""
kill -INT "$stats"
wait "$stats" || true
stats=""
python3 - "$out/load.csv" <<'PYTHON'
import csv, sys
rows = {}
for minute, name, rss, peak, cpu in csv.reader(open(sys.argv[1])):
    rows.setdefault(name, []).append((int(minute), float(rss), float(peak or 0), float(cpu or 0)))
some = lambda r: sorted({0, len(r) // 4, len(r) // 2, len(r) - 1})
first = next(iter(rows.values()))
print("| process |", " | ".join(f"MB at {first[i][0]} min" for i in some(first)), "| peak MB | CPU % |")
print("|---" * (len(some(first)) + 3) + "|")
for name, r in rows.items():
    load = f"{100 * r[-1][3] / (60 * r[-1][0]):.0f}" if r[-1][3] else ""
    print(f"| {name} |", " | ".join(f"{r[i][1]:.0f}" for i in some(r)), f"| {r[-1][2]:.0f} | {load} |")
PYTHON
echo "seen from outside: $(cat "$out/live_stats.json")"
[ "$code" -eq 0 ] || { tail -n 20 "$out/log"; exit "$code"; }
