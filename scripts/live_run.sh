#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs the five processes over LCM on a recording at its own pace, in a network of their own, and measures the result.
#   scripts/live_run.sh BUILD_DIR INPUT OUT [camera_driver's flags, or --set of rumi up ...]
# INPUT: whatever camera_driver reads. With RUMI_LIVE_PLAYER=lcm-logplayer INPUT is an lcm log and that plays it instead.
# RUMI_LIVE_TRUTH=FILE: evaluate against it. RUMI_LIVE_CONFIG=FILE: instead of config/rumi.yaml.
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
code=0
wait "$up" || code=$?
up=""
kill -INT "$stats"
wait "$stats" || true
stats=""
[ "$code" -eq 0 ] || exit "$code"

echo "seen from outside: $(cat "$work/stats.json")"
cp "$work/stats.json" "$out/live_stats.json"
if [ -n "${RUMI_LIVE_TRUTH:-}" ]; then
  "$build/bin/rumi" evaluate "$out" --groundtruth "$RUMI_LIVE_TRUTH"
fi
