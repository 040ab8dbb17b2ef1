#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The five processes live under ThreadSanitizer, on a rendered walk with a loss in it, and its end. Ends with 1 if there
# was a report, and prints it.
#   scripts/tsan_live.sh BUILD_DIR [SPEED]
# BUILD_DIR is of -DRUMI_SANITIZE=thread. SPEED (0.1) of the recording: an image takes ten times as long.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/in_netns.sh
. "$here/scripts/in_netns.sh"
build=$1
speed=${2:-0.1}
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'
TSAN_OPTIONS="suppressions=$here/tests/tsan.supp"
export TSAN_OPTIONS
"$build/bin/rumi" synth -q -o "$work/walk" --seconds 6 --hard blur --at 3 --for 1
code=0
"$build/bin/rumi" up "$here/config/rumi.yaml" "$work/walk" --lcm-url "$url" --speed "$speed" --snapshot "$work/out" \
  --set image.max_image_side=320 --set map_server.database="$work/map.db" --set map_server.snapshot_s=5 --set map_server.snapshot_file="$work/copy.db" \
  --set ruminator.spool="$work/spool" --set viewer_offscreen.output="$work" 2>"$work/log" || code=$?
if [ "$code" -ne 0 ]; then tail -n 30 "$work/log"; fi
if grep -q 'WARNING: ThreadSanitizer' "$work/log"; then
  sed -n '/WARNING: ThreadSanitizer/,/^[^|]*| SUMMARY/p' "$work/log"
  code=1
fi
grep -E 'frames have a pose in the map|submap -1' "$work/log" | tail -n 2
exit "$code"
