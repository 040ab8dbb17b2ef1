#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Renders a short sequence of a room, runs the five components on it, and measures the result against the true path.
#   scripts/demo.sh RUMI DIR
set -eu
rumi=$1
dir=$2
mkdir -p "$dir"
echo "== Rendering a short sequence of a room into $dir/sequence"
rm -rf "$dir/sequence"
"$rumi" synth -o "$dir/sequence" --seconds 15
echo
echo "== Running camera_driver, front_tracker, ruminator, map_server and viewer_offscreen on it"
"$rumi" replay "$dir/sequence" -o "$dir/run"
echo
echo "== Comparing with the true path"
"$rumi" evaluate "$dir/run" --groundtruth "$dir/sequence/groundtruth.txt"
cat <<END

Done. What was made:
  trajectory (TUM format)        $dir/run/trajectory.txt
  map                            $dir/run/map.db, $dir/run/map.ply
  picture of trajectory and map  $dir/run/trajectory.png
  picture of the error           $dir/run/evaluation.png
  the images it was made from    $dir/sequence/rgb
END
