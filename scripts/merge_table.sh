#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's Table IV on rendered sequences: the one map that front and back submaps make, with and without
# post-culling, and what there is with the front alone. Replays sequences along true camera paths with a passage that is
# hard, and writes a Markdown table to the terminal and OUT/merge_table.csv, OUT/merge_runs.csv.
#   scripts/merge_table.sh BUILD_DIR TRAJECTORIES OUT [RUNS]
# The arguments, the sequences, their choice by RUMI_TABLE_SEQUENCES and RUMI_TABLE_KINDS, and OUT/*/sequence and
# OUT/*/front are those of scripts/back_process_table.sh: in the same OUT nothing is rendered twice. What exists in OUT is
# kept, so that an interrupted run can be continued; remove OUT/*/culled and OUT/*/kept to measure again.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
trajectories=$2
out=$3
runs=${4:-3}
sequences=${RUMI_TABLE_SEQUENCES:-fr1_room:2 fr3_teddy:46 V102:36 icl_living_room_t2:6}
kinds=${RUMI_TABLE_KINDS:-blur dark textureless rotation}
length=12 begin=5 passage=2 # seconds
mkdir -p "$out"

replay() { # folder name option
  if [ -e "$1/$2/evaluation.json" ]; then return; fi
  "$rumi" replay -q "$1/sequence" -o "$1/$2" --set "$3"
  "$rumi" evaluate "$1/$2" --groundtruth "$1/sequence/groundtruth.txt" --json >"$1/$2/evaluation.json.part"
  mv "$1/$2/evaluation.json.part" "$1/$2/evaluation.json"
}

measure() { # sequence start kind seed
  folder=$out/$1_$3_$4
  mkdir -p "$folder"
  if [ ! -e "$folder/rendered" ]; then
    "$rumi" synth -q --overwrite -o "$folder/sequence" --path "$trajectories/$1.txt" --start "$2" --duration $length \
      --seed "$4" --hard "$3" --at $begin --for $passage
    touch "$folder/rendered"
  fi
  replay "$folder" front ruminator.rebuild=false
  replay "$folder" culled map_server.cull_back_keyframes=true
  replay "$folder" kept map_server.cull_back_keyframes=false
}

if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  # Run by run, so that what is there after an interruption compares.
  for seed in $(seq "$runs"); do
    for sequence in $sequences; do
      for kind in $kinds; do measure "${sequence%%:*}" "${sequence##*:}" "$kind" "$seed"; done
    done
  done
fi
python3 "$here/merge_table.py" "$out"
