#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The whole system live on a camera of the kernel's V4L2: Debian's kernel in QEMU, and a recording that v4l2loopback gives
# out as a camera, each of its images once and then again from the beginning.
#   scripts/loopback_run.sh BUILD_DIR RECORDING MINUTES [RATE_HZ]
# Prints how many images were fed, where they went (`rumi status` after the last one), and the tables of
# scripts/long_run.sh; the log is BUILD_DIR/tests/virtual_machine/loopback_run.log, and while it runs in "console" beside it.
# The machine does an instruction in a nanosecond, by its own clock: some ten times slower than its host, so RATE_HZ (whole,
# 2) is far below the recording's, but how busy the host is counts little. MINUTES are the machine's too: QEMU takes
# several times as long.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
if [ "${1:-}" != --inside ]; then
  [ $# -ge 3 ] || { sed -n "3,10s/^# //p" "$0" >&2; exit 2; }
  work=$(realpath "$1")/tests/virtual_machine
  mkdir -p "$work"
  code=0
  RUMI_QEMU_FLAGS="-icount shift=0" RUMI_QEMU_MEMORY_MB=3072 RUMI_QEMU_TIMEOUT_S=$((20 * 60 * ($3 + 3))) \
    "$here/../tests/virtual_machine/run_in_qemu.sh" "$work" \
    "$here/loopback_run.sh" --inside "$(realpath "$1")" "$(realpath "$2")" "$3" "${4:-2}" >"$work/loopback_run.log" || code=$?
  sed -n '/images fed/,/^RUMI_EXIT_CODE/p' "$work/loopback_run.log" | grep -v ^RUMI
  [ "$code" -eq 0 ] || tail -n 30 "$work/loopback_run.log" >&2
  exit "$code"
fi
build=$2
recording=$3
minutes=$4
rate=$5
out=/run/out

# What is told in seconds is meant for a camera's pace: as many images as there.
fps=$(sed -n 's/^fps: *//p' "$recording/calibration.yaml")
slower() { awk -v f="${fps:-30}" -v r="$rate" -v s="$1" 'BEGIN {print s * f / r}'; }
echo 2097152 >/proc/sys/net/core/rmem_max # as docs/camera.md says

all_run() { [ "$("$build/bin/rumi" status --json 2>/dev/null | grep -c '"state": "running"')" -ge 5 ]; } # and live_stats
{
  until all_run; do sleep 1; done
  echo
} | "$build/tests/feed_camera" "$recording" "$rate" $((60 * minutes * rate)) >/run/fed &
feeder=$!
echo "waiting for the recording"
until [ -s /run/fed ]; do sleep 1; done
tail -n +1 -F "$out.log" 2>/dev/null & # as it comes: it takes long
# More minutes than it takes; the camera waits for its first image, and then for the end.
"$here/long_run.sh" "$build" /dev/video8 "$out" $((minutes + 10)) --camera "$recording/calibration.yaml" \
  --set camera_driver.rate="$rate" --set camera_driver.stall=600 --set up.viewer=false \
  --set front_tracker.recently_lost_s="$(slower 1)" --set front_tracker.publish_interval_s="$(slower 0.5)" \
  --set map_server.place_min_apart_s="$(slower 5)" >/run/tables &
run=$!
while kill -0 "$feeder" 2>/dev/null; do
  kill -0 "$run" 2>/dev/null || exit 1 # the log says why
  sleep 1
done
wait "$feeder"
sleep 10 # for what is still on its way
"$build/bin/rumi" status >/run/status
pkill -INT -x -P "$(pgrep -x -P "$run" live_run.sh)" rumi
code=0
wait "$run" || code=$?
sleep 2 # for the end of the log
tail -n 1 /run/fed
cat /run/status /run/tables
exit "$code"
