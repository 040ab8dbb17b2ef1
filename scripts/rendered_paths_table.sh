#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The front process alone on rendered sequences along true camera paths: how many frames it tracks, in how many submaps,
# how true each is, and what a frame costs. Each path twice: 12 s as it is, and 20 s with four passages that are hard, one
# of each kind. Prints a Markdown table and writes OUT/table.csv.
#   scripts/rendered_paths_table.sh BUILD_DIR TRAJECTORIES OUT
# TRAJECTORIES: folder of TUM files (t tx ty tz qx qy qz qw).
# RUMI_TABLE_SEQUENCES="NAME:START ...": other paths, and where on them to begin, s. RUMI_TABLE_KINDS ("plain hard"): plain,
# hard, or blur, dark, textureless, rotation for a sequence with that passage alone. RUMI_TABLE_KEEP=1: the images stay
# (1.5 MB a second of each sequence). What is measured in OUT is kept, so that an interrupted run can be continued.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
trajectories=$2
out=$3
. "$here/rendered_paths.sh"
sequences=${RUMI_TABLE_SEQUENCES:-$rendered_paths}
kinds=${RUMI_TABLE_KINDS:-plain hard}
mkdir -p "$out"

measure() { # sequence start kind
  folder=$out/$1_$3
  mkdir -p "$folder"
  if [ ! -e "$folder/rendered" ]; then
    render_path "$folder/sequence" "$1:$2" "$3"
    touch "$folder/rendered"
  fi
  "$rumi" replay -q "$folder/sequence" -o "$folder/front" --set ruminator.rebuild=false --set map_server.merge=false ||
    [ $? -eq 3 ]
  "$rumi" evaluate "$folder/front" --groundtruth "$folder/sequence/groundtruth.txt" --json >"$folder/part" ||
    [ -s "$folder/part" ] # what tracked nothing has figures, too
  mv "$folder/part" "$folder/evaluation.json"
  if [ -z "${RUMI_TABLE_KEEP:-}" ]; then rm -rf "$folder/sequence" "$folder/rendered" "$folder/front"; fi
}

if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  for kind in $kinds; do
    for sequence in $sequences; do
      if [ ! -e "$out/${sequence%%:*}_$kind/evaluation.json" ]; then
        measure "${sequence%%:*}" "${sequence##*:}" "$kind"
      fi
    done
  done
fi
python3 -B "$here/rendered_paths_table.py" "$out"
