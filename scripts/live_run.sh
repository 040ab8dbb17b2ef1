#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs the five processes over LCM on a recording at its own pace, in a network of their own, and measures the result.
#   scripts/live_run.sh BUILD_DIR INPUT OUT [camera_driver's flags, or --set of rumi up ...]
# INPUT: whatever camera_driver reads. With RUMI_LIVE_PLAYER=lcm-logplayer INPUT is an lcm log and that plays it instead.
# RUMI_LIVE_TRUTH=FILE: evaluate against it. RUMI_LIVE_CONFIG=FILE: instead of config/rumi.yaml.
# RUMI_LIVE_MINUTES=N: end it after so long, and note what each process takes every minute in OUT/load.csv:
# minute,process,rss_mb,peak_mb,cpu_s (map.db: its size in MB).
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
if [ "${RUMI_IN_NETNS:-}" != 1 ]; then
  exec "$here/tests/run_in_netns.sh" "$0" "$@"
fi
build=$1
input=$2
out=$3
shift 3
config=${RUMI_LIVE_CONFIG:-$here/config/rumi.yaml}
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'
work=$(mktemp -d)
stats=""
up=""
cleanup() {
  for pid in $up $stats; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap cleanup EXIT

ticks=$(getconf CLK_TCK)
note_load() { # MINUTE
  for pid in $(pgrep -P "$up"); do
    name=$(basename "$(tr '\0' '\n' <"/proc/$pid/cmdline" | head -n 1)") || continue
    cpu=$(awk -v t="$ticks" '{print ($14 + $15 + $16 + $17) / t}' "/proc/$pid/stat") || continue
    awk -v m="$1" -v n="$name" -v c="$cpu" '/^VmRSS/ {r = $2} /^VmHWM/ {h = $2}
      END {printf "%d,%s,%.1f,%.1f,%.1f\n", m, n, r * 1.024e-3, h * 1.024e-3, c}' "/proc/$pid/status"
  done
  du -cB1 "$work"/map.db* | awk -v m="$1" 'END {printf "%d,map.db,%.1f,,\n", m, $1 * 1e-6}'
}

"$build/tests/live_stats" -q --lcm-url "$url" >"$work/stats.json" &
stats=$!
set -- --lcm-url "$url" --set "map_server.database=$work/map.db" --set "ruminator.spool=$work/spool" --set "viewer_offscreen.output=$work" \
  --snapshot "$out" "$@"
if [ "${RUMI_LIVE_PLAYER:-}" = lcm-logplayer ]; then
  "$build/bin/rumi" up "$config" --set up.input= "$@" &
  up=$!
  sleep 2 # the player waits for nobody
  lcm-logplayer --lcm-url="$url" "$input" >/dev/null
  sleep 2
  kill -INT "$up"
else
  "$build/bin/rumi" up "$config" "$input" "$@" &
  up=$!
fi
if [ -n "${RUMI_LIVE_MINUTES:-}" ]; then
  for minute in $(seq "$RUMI_LIVE_MINUTES"); do
    sleep 60
    kill -0 "$up" 2>/dev/null || break
    note_load "$minute" >>"$work/load.csv"
  done
  kill -INT "$up" 2>/dev/null || true
fi
code=0
wait "$up" || code=$?
up=""
kill -INT "$stats"
wait "$stats" || true
stats=""
if [ -e "$work/load.csv" ]; then # not earlier: the snapshot wants a folder of its own
  mkdir -p "$out"
  cp "$work/load.csv" "$out/load.csv"
fi
[ "$code" -eq 0 ] || exit "$code"

echo "seen from outside: $(cat "$work/stats.json")"
cp "$work/stats.json" "$out/live_stats.json"
if [ -n "${RUMI_LIVE_TRUTH:-}" ]; then
  "$build/bin/rumi" evaluate "$out" --groundtruth "$RUMI_LIVE_TRUTH"
fi
