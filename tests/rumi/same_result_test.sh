#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The same recording gives the same files to the bit, whichever variants of its functions the C library picks and with any
# number of BLAS threads.
#   same_result_test.sh RUMI
# OpenCV's variants are not in it: cv::ORB describes some keypoints otherwise without AVX2.
set -eu
rumi=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$rumi" synth -q -o "$work/recording" --seconds 4 --size 320x240

replay() { # NAME [VARIABLE=VALUE]...
  name=$1
  shift
  env "$@" "$rumi" replay -q "$work/recording" -o "$work/$name" >/dev/null
}
replay usual OPENBLAS_NUM_THREADS=1
[ "$(wc -l <"$work/usual/trajectory.txt")" -gt 60 ] || { echo "FAILED: hardly anything is tracked" >&2 && exit 1; }
replay four_threads OPENBLAS_NUM_THREADS=4 OMP_NUM_THREADS=4
replay plain_libc GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX,-AVX512F
for other in four_threads plain_libc; do
  for file in trajectory.txt frames.csv map.ply; do
    cmp "$work/usual/$file" "$work/$other/$file" || { echo "FAILED: $file is another with $other" >&2 && exit 1; }
  done
done
