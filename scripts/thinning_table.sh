#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# How few images are enough? Replays recordings of which every K-th image is left, beside COLMAP's own run on the same
# images, and prints a Markdown table: frames in the map, how many of them are false, the error, and CPU seconds. Writes
# OUT/table.csv.
#   scripts/thinning_table.sh BUILD_DIR DATA OUT [K ...]
# DATA: folder with recordings in it and in DATA/real, as for recordings_table.sh. K (1 2 4 8 16): as long as 20 images
# are left. Those with few images come first. What is measured in OUT is kept, so that it can be stopped and go on. The
# log of each replay (-v) is OUT/NAME/K/ours/log.
# COLMAP (colmap_run.py) matches each image with some before it (sequential) and, of few images, all with all
# (exhaustive). RUMI_TABLE_RECORDINGS="NAME ...": only these. RUMI_TABLE_COLMAP_S (900): CPU seconds that a run of COLMAP
# may take. RUMI_TABLE_COLMAP_IMAGES (400), RUMI_TABLE_EXHAUSTIVE_IMAGES (160): most images for either.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3 and colmap.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
data=$2
out=$3
shift 3
least_images=20
most_images=${RUMI_TABLE_COLMAP_IMAGES:-400}
most_exhaustive=${RUMI_TABLE_EXHAUSTIVE_IMAGES:-160}
limit_s=${RUMI_TABLE_COLMAP_S:-900}
recordings=${RUMI_TABLE_RECORDINGS:-redkitchen hololens v1_03_rendered fr3_office_1hz alva_desk kitti00_416
  sfm_castle_p30 giza_terrace}
mkdir -p "$out"

stored() { # name
  if [ -e "$data/$1" ]; then echo "$data/$1"; else echo "$data/real/$1"; fi
}

cells() { # K ...: lines of IMAGES NAME K
  for recording in $recordings; do
    images=$(grep -cv '^#' "$(stored "$recording")/rgb.txt")
    for k in "$@"; do
      left=$(((images + k - 1) / k))
      if [ "$k" = 1 ] || [ "$left" -ge "$least_images" ]; then echo "$left $recording $k"; fi
    done
  done | sort -n -s
}

# The length of the true path between the first image and the last. It does not depend on how many are left.
true_path() { # recording truth
  awk '/^#/ { next }
    NR == FNR { if (!n++) first = $1; last = $1; next }
    $1 >= first - .02 && $1 <= last + .02 {
      if (m++) path += sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2 + ($4 - z) ^ 2)
      x = $2; y = $3; z = $4
    }
    END { print path + 0 }' "$1/rgb.txt" "$2"
}

evaluate() { # folder recording; the whole recording is $whole
  for truth in "$2/groundtruth.txt" "$2/colmap.txt"; do
    if [ ! -e "$truth" ]; then continue; fi
    path=$(true_path "$whole" "$truth")
    echo "$path" >"$1/true_path"
    "$rumi" evaluate "$1/run" --groundtruth "$truth" --true-distance "$(echo "$path" | awk '{ print .03 * $1 }')" --json \
      >"$1/evaluation.json" 2>>"$1/log" || true
    return 0
  done
}

replay() { # folder recording
  if [ -e "$1/done" ]; then return 0; fi
  rm -rf "$1"
  mkdir -p "$1"
  # A shell of its own, so that `times` tells of this child alone.
  (
    code=0
    "$rumi" replay -v "$2" -o "$1/run" >"$1/log" 2>&1 || code=$?
    echo "$code" >"$1/exit_code"
    times >"$1/times"
  )
  evaluate "$1" "$2"
  touch "$1/done"
}

run_colmap() { # folder recording matcher
  if [ -e "$1/done" ]; then return 0; fi
  rm -rf "$1"
  mkdir -p "$1"
  # shellcheck disable=SC2154 # names: set by colmap_names.sh
  python3 -B "$here/colmap_run.py" "$2" "$1/run" "$3" --names "$extraction" "$matching" --limit-s "$limit_s" \
    --features "$1/../features" >"$1/log" 2>&1 || {
    tail -n 3 "$1/log" >&2
    return 0
  }
  if [ -s "$1/run/trajectory.txt" ]; then evaluate "$1" "$2"; fi
  touch "$1/done"
}

measure() { # images name k
  whole=$(stored "$2")
  cell=$out/$2/$3
  mkdir -p "$cell"
  echo "$1" >"$cell/images"
  python3 -B "$here/derived_recording.py" "$whole" "$cell/recording" --every "$3"
  replay "$cell/ours" "$cell/recording"
  if [ "$1" -gt "$most_images" ]; then
    mkdir -p "$cell/sequential"
    echo "more than $most_images images" >"$cell/sequential/skipped"
    return 0
  fi
  rm -f "$cell/sequential/skipped"
  run_colmap "$cell/sequential" "$cell/recording" sequential
  if [ "$1" -le "$most_exhaustive" ]; then run_colmap "$cell/exhaustive" "$cell/recording" exhaustive; fi
}

if [ -z "${RUMI_TABLE_ONLY:-}" ]; then
  # shellcheck source=scripts/colmap_names.sh
  . "$here/colmap_names.sh"
  if [ $# = 0 ]; then set -- 1 2 4 8 16; fi
  cells "$@" >"$out/cells"
  while read -r images name k; do
    echo "$(date +%T) $name, every $k: $images images" >&2
    measure "$images" "$name" "$k" </dev/null
  done <"$out/cells"
fi
python3 -B "$here/thinning_table.py" "$out"
