#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What images take of the bus, and what arrives with receive buffers of several sizes: a table in Markdown.
#   scripts/bandwidth_table.sh BUILD_DIR [HOLD_S]
# HOLD_S: the receivers are stopped for so many seconds twice a second, as happens on a busy machine (0: they are not).
# Real processes in a network of their own: a camera_driver for each camera, and a receiver for each that only counts.
# Each cell is images received of those published at 30 Hz in 3 s.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/in_netns.sh
. "$here/scripts/in_netns.sh"
build=$(cd "$1" && pwd)
hold_s=${2:-0}
images=90

# A second of a room as JPEG files, again and again: folder $work/SIZE, calibration $work/SIZE.yaml.
make_images() {
  "$build/bin/rumi" synth -q -o "$work/$1.synth" --seconds 1 --size "$1"
  cp "$work/$1.synth/calibration.yaml" "$work/$1.yaml"
  mkdir "$work/$1"
  i=0
  while [ $i -lt $images ]; do
    for file in "$work/$1.synth"/rgb/*; do
      [ $i -lt $images ] || break
      ln -s "$file" "$work/$1/$(printf %06d $i).jpg"
      i=$((i + 1))
    done
  done
}

field() { sed -n "s/.*\"$2\":\([0-9.]*\).*/\1/p" "$1"; }

hold() {
  [ "$hold_s" != 0 ] || exec sleep 1000
  while kill -STOP "$@" && sleep "$hold_s" && kill -CONT "$@"; do sleep 0.4; done
}

# run URL CAMERA...: CAMERA is SIZE-ENCODING. Leaves "MB/s" in $mb and "received of published" in $received.
run() {
  lcm_url=$1
  shift
  n=0
  receivers=""
  for camera in "$@"; do
    n=$((n + 1))
    "$build/tests/live_stats" -q -l "$lcm_url" -c "CAMERA_$n" >"$work/$n.json" 2>/dev/null &
    receivers="$receivers $!"
  done
  pids=$receivers
  until [ "$(grep -c ':1DF3 ' /proc/net/udp)" -ge "$n" ]; do sleep 0.1; done # they listen
  n=0
  drivers=""
  for camera in "$@"; do
    n=$((n + 1))
    size=${camera%-*}
    "$build/bin/camera_driver" "$work/$size" --camera "$work/$size.yaml" --rate 30 --encoding "${camera#*-}" -q -l "$lcm_url" \
      -c "CAMERA_$n" 2>/dev/null &
    drivers="$drivers $!"
  done
  hold $receivers &
  holder=$!
  pids="$receivers $drivers $holder"
  for pid in $drivers; do wait "$pid"; done
  kill "$holder"
  wait "$holder" 2>/dev/null || true
  kill -CONT $receivers
  sleep 1
  for pid in $receivers; do kill -INT "$pid" && wait "$pid"; done
  pids=""
  mb=0
  received=0
  for i in $(seq "$n"); do
    mb=$(echo "$mb $(field "$work/$i.json" image_mb_per_s)" | awk '{print $1 + $2}')
    received=$((received + $(field "$work/$i.json" images)))
  done
  received="$received of $((n * images))"
}

make_images 640x480
make_images 1280x720
url='udpm://239.255.76.67:7667?ttl=0'
echo "net.core.rmem_default $(cat /proc/sys/net/core/rmem_default 2>/dev/null || echo '?'), rmem_max $(cat /proc/sys/net/core/rmem_max 2>/dev/null || echo '?'); load $(cut -d' ' -f1 /proc/loadavg) on $(nproc) CPUs; receivers stopped for $hold_s s twice a second"
echo
echo "| 30 Hz | MB/s | no \`recv_buf_size\` | 2 MB | 8 MB |"
echo "|---|---|---|---|---|"
row() {
  name=$1
  shift
  line=""
  for option in '' '&recv_buf_size=2097152' '&recv_buf_size=8388608'; do
    run "$url$option" "$@"
    line="$line $received |"
  done
  echo "| $name | $(echo "$mb" | awk '{printf "%.1f", $1}') |$line"
}
row "MJPEG 640 x 480" 640x480-jpeg
row "grey 640 x 480" 640x480-grey
row "MJPEG 1280 x 720" 1280x720-jpeg
row "grey 1280 x 720" 1280x720-grey
row "two cameras 640 x 480, MJPEG and grey" 640x480-jpeg 640x480-grey
row "two cameras 1280 x 720, MJPEG and grey" 1280x720-jpeg 1280x720-grey
