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
sequences=${RUMI_TABLE_SEQUENCES:-fr1_room:2 fr1_floor:4 fr1_teddy:4 fr2_desk:10 fr2_pioneer_slam:20 fr3_teddy:40
  V102:20 V103:20 V203:20 icl_living_room_t0:4 icl_living_room_t1:4 icl_living_room_t2:4 icl_living_room_t3:4
  icl_office_t0:4 icl_office_t1:4 icl_office_t2:4 icl_office_t3:4}
kinds=${RUMI_TABLE_KINDS:-plain hard}
passage=1.5 # seconds
mkdir -p "$out"

how() { # kind
  case $1 in
    plain) echo --duration 12 ;;
    hard) echo "--duration 20 --hard blur --at 5 --for $passage --hard dark --at 9 --for $passage" \
      "--hard textureless --at 13 --for $passage --hard rotation --at 17 --for $passage" ;;
    *) echo "--duration 12 --hard $1 --at 5 --for $passage" ;;
  esac
}

measure() { # sequence start kind
  folder=$out/$1_$3
  mkdir -p "$folder"
  if [ ! -e "$folder/rendered" ]; then
    "$rumi" synth -q --overwrite -o "$folder/sequence" --path "$trajectories/$1.txt" --start "$2" \
      $(how "$3")
    touch "$folder/rendered"
  fi
  "$rumi" replay -q "$folder/sequence" -o "$folder/front" --set ruminator.rebuild=false --set map_server.merge=false
  "$rumi" evaluate "$folder/front" --groundtruth "$folder/sequence/groundtruth.txt" --json >"$folder/part"
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
python3 "$here/rendered_paths_table.py" "$out"
