#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The whole system on every recording there is, real and rendered: prints a Markdown table, median and worst over the
# seeds, and writes OUT/table.csv and OUT/runs.csv.
#   scripts/recordings_table.sh BUILD_DIR DATA OUT [SEEDS]
# DATA: folder with recordings (rgb.txt, calibration.yaml and, where known, groundtruth.txt or another estimate,
# colmap.txt) in it and in DATA/real, and with true camera paths (TUM files) in DATA/trajectories to render along.
# SEEDS (1): runs of each; they differ in the number of keypoints, which changes every random choice after it.
# What is measured in OUT is kept, so that an interrupted run can be continued.
# RUMI_TABLE_RECORDINGS="NAME ...": only these; backwards_NAME is NAME played backwards, every3_NAME every third image of
# it (derived_recording.py): recordings that nothing was set on; KIND_NAME is NAME with something in its images that is not
# the world (disturbed_recordings.py, which needs python3-opencv). street_05 is a drive through a rendered town along
# DATA/trajectories/kitti/05.txt, hardstreet_05 the same with three hard passages, street_campus a robot's round of 735 s.
# RUMI_TABLE_SET="KEY=VALUE ...": other options. RUMI_TABLE_JOBS: runs at a
# time (1: CPU times are then good). RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
data=$2
trajectories=$data/trajectories
out=$3
seeds=${4:-1}
. "$here/rendered_paths.sh"
mkdir -p "$out"
disturbances=$(echo $(python3 -B "$here/disturbances.py"))

names() {
  for list in "$data"/*/rgb.txt "$data"/real/*/rgb.txt; do
    folder=${list%/rgb.txt}
    if [ -e "$folder/calibration.yaml" ]; then basename "$folder"; fi
  done
  for path in $rendered_paths; do
    if [ -e "$trajectories/${path%%:*}.txt" ]; then echo "rendered_${path%%:*}" "passages_${path%%:*}"; fi
  done
}

# The folder of one that lies in DATA.
stored() { # name
  if [ -e "$data/$1" ]; then echo "$data/$1"; else echo "$data/real/$1"; fi
}

is_disturbed() { # name
  case " $disturbances " in *" ${1%%_*} "*) return 0 ;; esac
  return 1
}

# Renders or derives a recording where it is not there yet. Leaves its folder in $folder.
find_recording() { # name
  case $1 in
    rendered_* | passages_* | backwards_* | every[0-9]*_* | street_* | hardstreet_*) ;;
    *)
      if ! is_disturbed "$1"; then
        folder=$(stored "$1")
        return 0
      fi
      ;;
  esac
  folder=$out/sequences/$1
  if [ -e "$folder/done" ]; then return 0; fi
  kind=${1%%_*} path=${1#*_}
  if is_disturbed "$1"; then
    find_recording "$path"
    plain=$folder folder=$out/sequences/$1
    /usr/bin/python3 -B "$here/disturbed_recordings.py" "$plain" "$folder" "${1%%_*}"
    touch "$folder/done"
    return 0
  fi
  case $kind in
    street | hardstreet) render_street "$folder" "$kind" "$path" ;;
    backwards) python3 -B "$here/derived_recording.py" "$(stored "$path")" "$folder" --backwards ;;
    every*) python3 -B "$here/derived_recording.py" "$(stored "$path")" "$folder" --every "${kind#every}" ;;
    *)
      for p in $rendered_paths; do
        if [ "${p%%:*}" != "$path" ]; then continue; fi
        if [ "$kind" = passages ]; then render_path "$folder" "$p" hard; else render_path "$folder" "$p" plain; fi
      done
      ;;
  esac
  touch "$folder/done"
}

measure() { # name seed
  run=$out/$1/$2
  if [ -e "$run/evaluation.json" ] || [ -e "$run/no_truth" ]; then return 0; fi
  find_recording "$1"
  options="--set front_tracker.keypoints=$((1000 + 7 * (2 * ($2 % 2) - 1) * (($2 + 1) / 2)))"
  for option in ${RUMI_TABLE_SET:-}; do options="$options --set $option"; done
  rm -rf "$run"
  mkdir -p "$run"
  # shellcheck disable=SC2086
  code=0
  "$rumi" replay -q "$folder" -o "$run/run" $options >"$run/log" 2>&1 || code=$?
  echo "$code" >"$run/exit_code"
  case $code in 0 | 3) ;; *) echo "$1, seed $2: see $run/log" >&2 ;; esac
  # Without a truth what is disturbed is held against the path of the recording as it is.
  own=
  if is_disturbed "$1"; then own=$out/${1#*_}/0/run/trajectory.txt; fi
  for truth in "$folder/groundtruth.txt" "$folder/colmap.txt" "$own"; do
    if [ ! -e "$truth" ]; then continue; fi
    basename "$truth" .txt >"$run/truth"
    if "$rumi" evaluate "$run/run" --groundtruth "$truth" --json >"$run/part" 2>>"$run/log" ||
      [ -s "$run/part" ]; then
      mv "$run/part" "$run/evaluation.json"
      return 0
    fi
  done
  touch "$run/no_truth"
}

if [ "${5:-}" = measure ]; then # one run, called by xargs below
  measure "$6" "$4"
  exit 0
fi
if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  for seed in $(seq 0 $((seeds - 1))); do
    for name in ${RUMI_TABLE_RECORDINGS:-$(names)}; do echo "$seed measure $name"; done
  done | xargs -P "${RUMI_TABLE_JOBS:-1}" -L 1 "$0" "$1" "$data" "$out"
fi
python3 -B "$here/recordings_table.py" "$out"
