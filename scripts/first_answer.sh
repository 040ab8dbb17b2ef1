#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# How long front_tracker takes from its start to its first answer, where the camera runs already.
#   scripts/first_answer.sh BUILD_DIR RECORDING [STARTS]
# Prints the times, ms, in order. Needs lcm-logger (liblcm-bin) and python3.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/in_netns.sh
. "$here/scripts/in_netns.sh"
build=$1
recording=$2
starts=${3:-10}
url='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'

"$build/bin/camera_driver" -q -l "$url" --loop "$recording" &
pids=$!
lcm-logger -q --lcm-url="$url" -c RUMI_TRACK "$work/track.log" &
pids="$pids $!"
sleep 2
for _ in $(seq "$starts"); do
  date +%s%N >>"$work/starts"
  "$build/bin/front_tracker" -q -l "$url" &
  front=$!
  sleep 1
  kill -INT "$front"
  wait "$front"
done
# shellcheck disable=SC2086 # several
kill $pids
wait
pids=""
python3 - "$work" <<'P'
import struct
import sys

with open(sys.argv[1] + "/track.log", "rb") as f:
    log = f.read()
answers_us = []
at = 0
header = struct.Struct(">IqqII")  # of an lcm log's event: sync word, number, time, lengths of channel and data
while at + header.size <= len(log):
    _, _, utime_us, channel, data = header.unpack_from(log, at)
    answers_us.append(utime_us)
    at += header.size + channel + data
times_ms = []
for line in open(sys.argv[1] + "/starts"):
    start_us = int(line) / 1e3
    later = [t for t in answers_us if t >= start_us]
    if not later:
        sys.exit("front_tracker did not answer")
    times_ms.append((later[0] - start_us) / 1e3)
print("first answer after", " ".join(f"{t:.0f}" for t in sorted(times_ms)), "ms")
P
