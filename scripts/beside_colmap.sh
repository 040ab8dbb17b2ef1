#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command while COLMAP matches images on all cores at the lowest priority, over and over.
#   scripts/beside_colmap.sh IMAGE_FOLDER COMMAND...
# 60 images of the folder, spread over it, are matched. Prints last how much CPU COLMAP got meanwhile.
set -eu
images=$(cd "$1" && pwd)
shift
work=$(mktemp -d)
busy=""
# shellcheck disable=SC2317 # called by the trap
cleanup() {
  [ -z "$busy" ] || kill -- "-$busy" 2>/dev/null || true
  wait
  rm -rf "$work"
}
trap cleanup EXIT

find "$images" -maxdepth 1 -type f | sort >"$work/all.txt"
count=$(wc -l <"$work/all.txt")
[ "$count" -ge 60 ] || {
  echo "$images has $count images, 60 are needed" >&2
  exit 1
}
awk -v n="$count" 'int(NR * 60 / n) > int((NR - 1) * 60 / n)' "$work/all.txt" | sed 's|.*/||' >"$work/list.txt"
# shellcheck source=scripts/colmap_names.sh
. "$(dirname "$0")/colmap_names.sh"
echo "COLMAP extracts the features that it is to match ..."
colmap feature_extractor --database_path "$work/features.db" --image_path "$images" --image_list_path "$work/list.txt" \
  --ImageReader.single_camera 1 "--$extraction.use_gpu" 0 >"$work/extractor.log" 2>&1 || {
  cat "$work/extractor.log" >&2
  exit 1
}

# A session of its own has a scheduling group of its own, whose priority counts among groups.
# shellcheck disable=SC2016 # for the inner shell
setsid sh -c 'echo 19 >/proc/self/autogroup 2>/dev/null || true
  renice -n 19 $$ >/dev/null
  while cp "$1/features.db" "$1/matches.db"; do
    colmap exhaustive_matcher --database_path "$1/matches.db" "--$2.use_gpu" 0 >/dev/null 2>&1
  done' sh "$work" "$matching" &
busy=$!
sleep 2
ticks=$(getconf CLK_TCK)
colmap_cpu_s() { # of the matchers that ended and of the one that runs
  for pid in $(pgrep -g "$busy"); do cat "/proc/$pid/stat" 2>/dev/null || true; done |
    awk -v t="$ticks" '{s += $14 + $15 + $16 + $17} END {print s / t}'
}
before="$(date +%s) $(colmap_cpu_s)"
code=0
"$@" || code=$?
echo "$before $(date +%s) $(colmap_cpu_s) $(nproc)" |
  awk '{printf "beside it COLMAP got %.0f s of CPU in %d s on %d cores\n", $4 - $2, $3 - $1, $5}'
exit "$code"
