#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What `kill -9` costs: for each process live runs in which it is killed again and again (scripts/kill_run.sh), and one
# without kills. Prints a Markdown table: when the process was back and the camera's place in the map known again
# (median / worst), what of all that map_server had acknowledged is not in map.db at the end, and how many images have a
# pose in the map.
#   scripts/kills.sh BUILD_DIR INPUT OUT [--kills N] [--each M] [--seed S] [--jobs J] [PROCESS ...]
# INPUT: a recording. N (40): kills of each process, one every 12 s. M (25): at most so many in a run, as each of
# front_tracker leaves a submap of the same room to be joined. J (2): runs at a time. OUT must not have these runs.
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
each=25
while [ $# -gt 0 ]; do
  case $1 in
    --kills) kills=$2 ;;
    --each) each=$2 ;;
    --seed) seed=$2 ;;
    --jobs) jobs=$2 ;;
    *) break ;;
  esac
  shift 2
done
[ $# -gt 0 ] || set -- front_tracker map_server camera_driver ruminator viewer_offscreen
mkdir -p "$out"

# NAME PROCESS KILLS SEED of each run.
runs() {
  quiet=$each # without kills a few minutes tell as much
  [ "$quiet" -le 15 ] || quiet=15
  echo "none.1 none $quiet $seed"
  for process in "$@"; do
    left=$kills
    run=1
    while [ "$left" -gt 0 ]; do
      n=$each
      [ "$n" -le "$left" ] || n=$left
      echo "$process.$run $process $n $((seed + run))"
      left=$((left - n))
      run=$((run + 1))
    done
  done
}

for name in $(runs "$@" | cut -d' ' -f1); do
  if [ -e "$out/$name" ]; then
    echo "$out/$name exists: name a new folder" >&2
    exit 1
  fi
done
# shellcheck disable=SC2016 # the inner shell's
runs "$@" | xargs -P "$jobs" -L 1 sh -c '"$1" "$2" "$3" "$4/$5" "$6" "$7" "$8" || echo "the run $5 failed" >&2' sh \
  "$here/kill_run.sh" "$build" "$input" "$out"
python3 "$here/kills_table.py" "$build" "$out" none "$@"
