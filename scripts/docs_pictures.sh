#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Draws the pictures of README and docs/ anew, into docs/images: two recordings, the demo, a rendered calibration board.
#   scripts/docs_pictures.sh BUILD_DIR DATA     DATA: a folder with the recordings hololens and redkitchen_soft
# Takes three minutes of CPU time. The result is the same to the bit every time.
set -eu
[ $# -eq 2 ] || { sed -n '3,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
images=$(cd "$(dirname "$0")/.." && pwd)/docs/images
build=$(cd "$1" && pwd)
data=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" # a picture is named by the folder that is given
rumi=$build/bin/rumi

"$rumi" replay -q "$data/hololens" -o hololens --log hololens.lcm \
  --set viewer_offscreen.series=true --set viewer_offscreen.interval_s=0.5
"$rumi" evaluate hololens --groundtruth "$data/hololens/groundtruth.txt"
"$rumi" draw-window hololens.lcm -o "$images/window.png"
"$rumi" view hololens -o "$images/hololens.png" --groundtruth "$data/hololens/groundtruth.txt"
cp hololens/evaluation.png "$images/evaluation.png"
cp hololens/pictures/000094.png "$images/tracking.png" # at 71 s: just before the poses of the turn are withdrawn
cp hololens/pictures/000100.png "$images/live.png"     # the last one

"$rumi" replay -q "$data/redkitchen_soft" -o redkitchen_soft
"$rumi" view redkitchen_soft -o "$images/merging.png" --view top --groundtruth "$data/redkitchen_soft/groundtruth.txt"

"$rumi" demo -o demo
cp demo/rumi/trajectory.png "$images/trajectory.png"

"$build/tests/render_boards" boards pinhole 640 480 40
"$rumi" calibrate -q boards -o mycam.yaml --picture "$images/calibration.png"
