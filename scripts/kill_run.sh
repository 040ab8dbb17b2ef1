#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One live run in which one process is killed (kill -9) again and again, on a recording that is played in a loop as a
# camera would (the time of an image is when it is published), in a network of its own.
#   scripts/kill_run.sh BUILD_DIR INPUT OUT PROCESS KILLS SEED
# PROCESS: camera_driver, front_tracker, ruminator, map_server, viewer_offscreen; none: nobody is killed, for as long.
# OUT gets kills.csv (when, whom), bus.log (what was said, images apart), up.log, map.db, the run's outputs in run/, and
# end.txt: the exit code and the seconds from being asked to end to the end.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/in_netns.sh
. "$here/scripts/in_netns.sh"
build=$1
input=$2
out=$3
process=$4
kills=$5
seed=$6
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'
begin_s=15 # the map has begun
join_s=30  # after the last kill
end_s=600  # who takes longer to end hangs: a map that is not joined yet is joined first
mkdir -p "$out"

# Longer apart than the supervisor's longest delay of a restart, or each would be delayed more than the one before.
gaps() {
  awk -v n="$kills" -v s="$seed" 'BEGIN {srand(s); for (i = 0; i < n; ++i) printf "%.3f\n", 10.5 + 3 * rand()}'
}

kill_one() {
  [ "$process" != none ] || return 0
  pid=$(pgrep -P "$up" -f "^[^ ]*/$process ") || { echo "$(date +%s.%N),0,$process" >>"$out/kills.csv"; return 0; }
  echo "$(date +%s.%N),$pid,$process" >>"$out/kills.csv"
  kill -9 "$pid"
}

end() {
  asked=$(date +%s)
  kill -INT "$up" 2>/dev/null || true
  while kill -0 "$up" 2>/dev/null && [ $(($(date +%s) - asked)) -lt $end_s ]; do sleep 0.2; done
  if kill -9 "$up" 2>/dev/null; then echo "$process: did not end within $end_s s: killed" >&2; fi
  code=0
  wait "$up" || code=$?
  echo "$code $(($(date +%s) - asked))" >"$out/end.txt"
}

lcm-logger --lcm-url="$url" -c '(RUMI_(SUBMAP|SUBMAP_ACK|MAP_STATUS|TRACK|STATUS)|CAMERA_TO_MAP)' "$out/bus.log" \
  >/dev/null 2>"$out/logger.log" &
logger=$!
"$build/bin/rumi" up "$here/config/rumi.yaml" "$input" --lcm-url "$url" --set camera_driver.loop=true \
  --set camera_driver.live_stamps=true --set "map_server.database=$out/map.db" --set "ruminator.spool=$work/spool" \
  --set "viewer_offscreen.output=$work" --snapshot "$out/run" 2>"$out/up.log" &
up=$!
pids="$up $logger"
sleep $begin_s
: >"$out/kills.csv"
for gap in $(gaps); do
  kill -0 "$up" 2>/dev/null || break
  kill_one
  sleep "$gap"
done
sleep $((join_s - 12))
end
kill -INT "$logger"
wait "$logger" || true
pids=""
