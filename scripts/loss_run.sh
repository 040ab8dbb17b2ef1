#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One live run on a recording, at its own pace, over a bad network: in a network of its own datagrams are lost, sent twice
# and overtake one another.
#   scripts/loss_run.sh BUILD_DIR INPUT OUT LOSS DUPLICATE REORDER SEED [flags of rumi up ...]
# LOSS, DUPLICATE, REORDER: per cent of the datagrams. Where the kernel has netem it does so (`tc`); elsewhere a library that
# stands before the programs' sendmsg (tests/support/lossy_send.c). RUMI_LOSSY_BY=sendmsg: in any case.
# OUT gets bus.log (what came through, images apart), up.log, map.db, the run's outputs in run/, by.txt (who lost them),
# and end.txt: the exit code and the seconds from the last image to the end.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/in_netns.sh
. "$here/scripts/in_netns.sh"
build=$(cd "$1" && pwd)
input=$2
out=$3
loss=$4
duplicate=$5
reorder=$6
seed=$7
shift 7
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'
end_s=600 # who takes longer hangs
mkdir -p "$out"

spoil() {
  if [ "${RUMI_LOSSY_BY:-}" != sendmsg ] &&
    tc qdisc add dev lo root netem delay 2ms loss "$loss%" duplicate "$duplicate%" reorder "$reorder%" 2>/dev/null; then
    echo netem >"$out/by.txt"
  else
    preload=$build/tests/liblossy_send.so
    [ -e "$preload" ] || { echo "$preload is missing: build it" >&2; exit 1; }
    echo sendmsg >"$out/by.txt"
  fi
}

# It prints a line at its end.
last_image_s() { sed -n 's/.*camera_driver| \([0-9:]*\).*: the end$/\1/p' "$out/up.log" | head -n 1; }

preload=""
spoil
lcm-logger --lcm-url="$url" -c '(RUMI_(SUBMAP|SUBMAP_ACK|MAP_STATUS|TRACK|STATUS)|CAMERA_TO_MAP)' "$out/bus.log" \
  >/dev/null 2>"$out/logger.log" &
logger=$!
env ${preload:+LD_PRELOAD="$preload"} RUMI_LOSSY="$loss $duplicate $reorder $seed" timeout -k 10 $end_s \
  "$build/bin/rumi" up "$here/config/rumi.yaml" "$input" --lcm-url "$url" --set "map_server.database=$out/map.db" \
  --set "ruminator.spool=$work/spool" --set "viewer_offscreen.output=$work" --snapshot "$out/run" "$@" 2>"$out/up.log" &
up=$!
pids="$up $logger"
code=0
wait "$up" || code=$?
begin=$(last_image_s)
[ -n "$begin" ] && seconds=$(($(date +%s) - $(date -d "$begin" +%s))) || seconds=-1
echo "$code $seconds" >"$out/end.txt"
kill -INT "$logger"
wait "$logger" || true
pids=""
