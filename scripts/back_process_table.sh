#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's Table III on rendered sequences: what the front process has without the back process, what the back
# process adds, and what it costs. Renders sequences along true camera paths with a passage that is hard, replays each
# with the front alone, rebuilds the windows it announced, and writes a Markdown table to the terminal and
# OUT/table.csv, OUT/runs.csv.
#   scripts/back_process_table.sh BUILD_DIR TRAJECTORIES OUT [RUNS]
# TRAJECTORIES: folder of TUM files (t tx ty tz qx qy qz qw). RUNS (3): renderings of each sequence, each with a room and
# noise of its own. What exists in OUT is kept, so that an interrupted run can be continued; remove OUT/*/front or
# OUT/*/back to measure again without rendering again.
# RUMI_TABLE_SEQUENCES="NAME:START ...": other paths, and where on them to begin, s. RUMI_TABLE_KINDS: other passages.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
trajectories=$2
out=$3
runs=${4:-3}
# The passages fall on the faster turns of these paths.
sequences=${RUMI_TABLE_SEQUENCES:-fr1_room:2 fr3_teddy:46 V102:36 icl_living_room_t2:6}
kinds=${RUMI_TABLE_KINDS:-blur dark textureless rotation}
length=12 begin=5 passage=2 # seconds
mkdir -p "$out"

measure() { # sequence start kind seed
  folder=$out/$1_$3_$4
  mkdir -p "$folder"
  truth=$folder/sequence/groundtruth.txt
  if [ ! -e "$folder/rendered" ]; then
    "$rumi" synth -q --overwrite -o "$folder/sequence" --path "$trajectories/$1.txt" --start "$2" --duration $length \
      --seed "$4" --hard "$3" --at $begin --for $passage
    touch "$folder/rendered"
  fi
  if [ ! -e "$folder/front/evaluation.json" ]; then
    "$rumi" replay -q "$folder/sequence" -o "$folder/front" --set ruminator.rebuild=false
    "$rumi" evaluate "$folder/front" --groundtruth "$truth" --json >"$folder/front/evaluation.json.part"
    mv "$folder/front/evaluation.json.part" "$folder/front/evaluation.json"
  fi
  if [ ! -e "$folder/back/windows.jsonl" ]; then
    mkdir -p "$folder/back"
    : >"$folder/back/part"
    # A window that cannot be rebuilt is a result too.
    if ls "$folder"/front/windows/*.window >/dev/null 2>&1; then
      "$rumi" ruminate -q "$folder/front/windows" -o "$folder/back" --truth "$truth" --json \
        >"$folder/back/part" 2>"$folder/back/log" || true
    fi
    mv "$folder/back/part" "$folder/back/windows.jsonl"
  fi
}

if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  # Run by run, so that what is there after an interruption compares.
  for seed in $(seq "$runs"); do
    for sequence in $sequences; do
      for kind in $kinds; do measure "${sequence%%:*}" "${sequence##*:}" "$kind" "$seed"; done
    done
  done
fi
python3 "$here/back_process_table.py" "$out"
