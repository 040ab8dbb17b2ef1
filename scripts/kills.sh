#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What `kill -9` costs: for each process a live run in which it is killed again and again (scripts/kill_run.sh), and one
# without kills. Prints a Markdown table: when the process was back and the camera's place in the map known again
# (median / worst), what of all that map_server had acknowledged is not in map.db at the end, and how many images have a
# pose in the map.
#   scripts/kills.sh BUILD_DIR INPUT OUT [--kills N] [--seed S] [--jobs J] [PROCESS ...]
# INPUT: a recording. N (40): kills of each process, one every 12 s. J (2): runs at a time. OUT must not have these runs.
# Also writes OUT/kills.json. Needs python3, lcm-logger and pgrep. Ends with 1 if something acknowledged was lost or a run failed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 3 ] || { sed -n 's/^# //p' "$0" | sed 1d >&2; exit 2; }
build=$1
input=$2
out=$3
shift 3
kills=40
seed=1
jobs=2
while [ $# -gt 0 ]; do
  case $1 in
    --kills) kills=$2 ;;
    --seed) seed=$2 ;;
    --jobs) jobs=$2 ;;
    *) break ;;
  esac
  shift 2
done
[ $# -gt 0 ] || set -- front_tracker map_server camera_driver ruminator viewer_offscreen
mkdir -p "$out"
for process in none "$@"; do
  if [ -e "$out/$process" ]; then
    echo "$out/$process exists: name a new folder" >&2
    exit 1
  fi
done
quiet=$kills # without kills a few minutes tell as much
[ "$quiet" -le 15 ] || quiet=15
for process in none "$@"; do
  [ "$process" = none ] && n=$quiet || n=$kills
  echo "$process $n"
done | xargs -P "$jobs" -L 1 sh -c '"$1" "$2" "$3" "$4/$6" "$6" "$7" "$5" || echo "the run of $6 failed" >&2' sh \
  "$here/kill_run.sh" "$build" "$input" "$out" "$seed"
python3 "$here/kills_table.py" "$build" "$out" none "$@"
