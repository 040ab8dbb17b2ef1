#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Time, memory, registered images and error of rebuilding windows of 20 to 320 frames, against COLMAP with its default
# options on the same frames: feature_extractor, exhaustive_matcher, mapper, without GPU, starting from the same
# calibration. Prints a Markdown table and writes OUT/table.csv.
#   scripts/window_size_table.sh BUILD_DIR SEQUENCE OUT
# SEQUENCE: TUM-style folder with groundtruth.txt. RUMI_SIZE_STRIDE (3): frames from one image to the next.
# RUMI_SIZES ("20 40 80 160 320"). RUMI_COLMAP_LIMIT_S (600): CPU seconds that COLMAP may take for one size; a size larger
# than one that took longer is not tried with it (0: COLMAP is not run at all). RUMI_COLMAP_THREADS (1): more
# change the wall time only, not the CPU seconds that are compared. What exists in OUT is kept.
# Needs GNU time, jq and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rumi=$1/bin/rumi
sequence=$(realpath "$2")
out=$3
stride=${RUMI_SIZE_STRIDE:-3}
sizes=${RUMI_SIZES:-20 40 80 160 320}
limit=${RUMI_COLMAP_LIMIT_S:-600}
threads=${RUMI_COLMAP_THREADS:-1}
export QT_QPA_PLATFORM=offscreen GLOG_logtostderr=1
mkdir -p "$out"

timed() { # file command ...: appends "wall user system peak_kB"
  file=$1
  shift
  /usr/bin/time -q -a -o "$file" -f '%e %U %S %M' "$@"
}

value() { sed -n "s/^$1: *//p" "$sequence/calibration.yaml" | sed 's/ *#.*//'; }

# COLMAP's pixel (0, 0) is the corner of the first pixel, not its centre.
camera_parameters() {
  for name in fx fy cx cy k1 k2 p1 p2; do echo "$name $(value $name)"; done |
    awk '{ v = $2 + ($1 == "cx" || $1 == "cy" ? 0.5 : 0); printf "%s%.6f", (NR > 1 ? "," : ""), v }'
}

ours() { # size
  work=$out/$1
  "$rumi" cut-window -q "$sequence" -o "$work/frames.window" --gap "0..$((($1 - 1) * stride)):$stride"
  rm -f "$work/ours.time"
  timed "$work/ours.time" "$rumi" ruminate -q "$work/frames.window" --truth "$sequence/groundtruth.txt" --json \
    -o "$work/ours" >"$work/ours.json.part" || true
  mv "$work/ours.json.part" "$work/ours.json"
}

# shellcheck source=scripts/colmap_names.sh
. "$(dirname "$0")/colmap_names.sh"

# Runs COLMAP with what is left of the limit.
colmap_step() { # work command options ...
  work=$1
  shift
  left=$(awk -v limit="$limit" '{ used += $2 + $3 } END { left = int(limit - used); print (left > 1 ? left : 1) }' "$work/colmap.time")
  timed "$work/colmap.time" prlimit --cpu="$left" colmap "$@" >>"$work/colmap.log" 2>&1
}

colmap_steps() { # work
  colmap_step "$1" feature_extractor --database_path "$1/colmap.db" --image_path "$1/images" \
    --ImageReader.single_camera 1 --ImageReader.camera_model OPENCV --ImageReader.camera_params "$(camera_parameters)" \
    "--$extraction.use_gpu" 0 "--$extraction.num_threads" "$threads" &&
    colmap_step "$1" exhaustive_matcher --database_path "$1/colmap.db" "--$matching.use_gpu" 0 \
      "--$matching.num_threads" "$threads" &&
    colmap_step "$1" mapper --database_path "$1/colmap.db" --image_path "$1/images" --output_path "$1/models" \
      --Mapper.num_threads "$threads"
}

colmap_alone() { # size
  work=$out/$1
  rm -rf "$work/images" "$work/colmap.db" "$work/models" "$work/stopped"
  mkdir -p "$work/images" "$work/models"
  : >"$work/colmap.time"
  : >"$work/colmap.log"
  awk -v size="$1" -v stride="$stride" '!/^#/ && NF >= 2 { if (n % stride == 0 && n / stride < size) print; n++ }' \
    "$sequence/rgb.txt" | while read -r time image; do
    ln -s "$sequence/$image" "$work/images/$time.${image##*.}"
  done
  if ! colmap_steps "$work" &&
    awk -v limit="$limit" '{ used += $2 + $3 } END { exit used < limit - 5 }' "$work/colmap.time"; then
    touch "$work/stopped"
  fi
  for model in "$work"/models/*; do
    [ ! -e "$model/images.bin" ] ||
      colmap model_converter --input_path "$model" --output_path "$model" --output_type TXT >>"$work/colmap.log" 2>&1
  done
  touch "$work/colmap.done"
}

stopped=
for size in $sizes; do
  frames=$(awk '!/^#/ && NF >= 2' "$sequence/rgb.txt" | wc -l)
  if [ $(((size - 1) * stride)) -ge "$frames" ]; then
    echo "$size frames, one of $stride: the sequence has only $frames" >&2
    continue
  fi
  mkdir -p "$out/$size"
  [ -e "$out/$size/ours.json" ] || ours "$size"
  if [ "$limit" != 0 ] && [ -z "$stopped" ]; then
    [ -e "$out/$size/colmap.done" ] || colmap_alone "$size"
    [ ! -e "$out/$size/stopped" ] || stopped=1
  fi
done
python3 "$here/window_size_table.py" "$out" "$sequence/groundtruth.txt" "$limit"
