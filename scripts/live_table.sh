#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The whole system live, in real time, on recordings, several times each (scripts/live_run.sh): what is in the map, how
# true it is, and how fast and how large front_tracker is. Prints a Markdown table of medians and worst runs, and writes
# OUT/runs.csv.
#   scripts/live_table.sh BUILD_DIR DATA OUT RUNS RECORDING ...
# DATA: folder with a folder per RECORDING that holds the images and groundtruth.txt. What is measured in OUT is kept, so
# that an interrupted run can be continued. Runs differ by a few keypoints (1000, 993, 1007, 986, ...): where images come
# slowly front_tracker does the same to the bit in each run otherwise, and many runs tell no more than one. RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1
data=$2
out=$3
runs=$4
shift 4
mkdir -p "$out"
if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  for run in $(seq "$runs"); do
    for recording in "$@"; do
      folder=$out/${recording}_$run
      if [ -e "$folder/evaluation.json" ]; then continue; fi
      rm -rf "$folder"
      keypoints=$((1000 + (run % 2 * 2 - 1) * (run / 2) * 7))
      "$here/live_run.sh" "$build" "$data/$recording" "$folder" --set front_tracker.keypoints=$keypoints \
        >"$folder.log" 2>&1 || { tail -n 20 "$folder.log"; exit 1; }
      "$build/bin/rumi" evaluate "$folder" --groundtruth "$data/$recording/groundtruth.txt" --json >"$folder/part" ||
        [ -s "$folder/part" ]
      mv "$folder/part" "$folder/evaluation.json"
    done
  done
fi
python3 "$here/live_table.py" "$out" "$@"
