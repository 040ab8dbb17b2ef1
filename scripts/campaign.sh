#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What Rumi holds out, in one go, on a recording: processes that are killed, datagrams that are lost, bytes that make no
# sense, hours of running. Prints the tables that docs/experiments/2026-11-reliability.md has.
#   scripts/campaign.sh BUILD_DIR INPUT OUT [--kills N] [--minutes M] [--fuzz S] [--seed S] [--jobs J]
# INPUT: a recording of some 30 s or more, images as JPEG files. OUT: a new folder; the tables are OUT/*.md, too.
#   --kills N    of each of the five processes (40: 25 minutes with J = 2; 100: 55 minutes)      scripts/kills.sh
#   --minutes M  of the long live run (32; 120 for two hours)                                    scripts/long_run.sh
#   --fuzz S     seconds of fuzzing (300), where there is a scripts/fuzz.sh
#   --seed S     of the moments of the kills and of the losses (1)
#   --jobs J     live runs with kills at a time (2): each takes about half a processor
# As it is it takes a bit more than an hour on two processors. Needs what the scripts named above need: python3, lcm-logger,
# pgrep and network namespaces. Ends with 1 if one of them failed; the others are run all the same.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
usage() { sed -n '3,15s/^# \{0,1\}//p' "$0"; }
case "${1:-}" in
  --help | -h)
    usage
    exit 0
    ;;
esac
[ $# -ge 3 ] || { usage >&2; exit 2; }
build=$1
input=$2
out=$3
shift 3
kills=40
minutes=32
fuzz=300
seed=1
jobs=2
while [ $# -gt 0 ]; do
  [ $# -gt 1 ] || { echo "$1: its value is missing" >&2; exit 2; }
  case $1 in
    --kills) kills=$2 ;;
    --minutes) minutes=$2 ;;
    --fuzz) fuzz=$2 ;;
    --seed) seed=$2 ;;
    --jobs) jobs=$2 ;;
    *)
      echo "$1: not known" >&2
      usage >&2
      exit 2
      ;;
  esac
  shift 2
done
if [ -e "$out" ]; then
  echo "$out exists: name a new folder" >&2
  exit 1
fi
mkdir -p "$out"
failed=""

# part NAME TITLE COMMAND...
part() {
  name=$1
  echo
  echo "## $2"
  echo
  shift 2
  code=0
  "$@" >"$out/$name.md" || code=$?
  cat "$out/$name.md"
  [ "$code" -eq 0 ] || failed="$failed $name"
}

part kills "Kills: $kills of each process" \
  "$here/kills.sh" "$build" "$input" "$out/kills" --kills "$kills" --seed "$seed" --jobs "$jobs"
part losses "Lost datagrams" "$here/losses.sh" "$build" "$input" "$out/losses" --seed "$seed"
part hours "$minutes minutes of running" "$here/long_run.sh" "$build" "$input" "$out/hours" "$minutes"
if [ -x "$here/fuzz.sh" ]; then part fuzz "Bytes that make no sense" "$here/fuzz.sh" --seconds "$fuzz"; fi
[ -z "$failed" ] || { echo "failed:$failed" >&2; exit 1; }
