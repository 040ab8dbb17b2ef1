#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Is the map complete over a bad network, and how long does it take? Live runs (scripts/loss_run.sh) with no, 30 % and 60 %
# of all datagrams lost, 5 % of the others sent twice and 25 % overtaken. Prints a Markdown table.
#   scripts/losses.sh BUILD_DIR INPUT OUT [--seed S] [flags of rumi up ...]
# Needs python3 and lcm-logger. Also writes OUT/losses.json. Ends with 1 if a map is not complete or a run failed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 3 ] || { sed -n 's/^# //p' "$0" | sed 1d >&2; exit 2; }
build=$1
input=$2
out=$3
shift 3
seed=1
if [ "${1:-}" = --seed ]; then
  seed=$2
  shift 2
fi
mkdir -p "$out"
for loss in 0 30 60; do
  if [ -e "$out/$loss" ]; then
    echo "$out/$loss exists: name a new folder" >&2
    exit 1
  fi
  spoilt="5 25"
  [ "$loss" != 0 ] || spoilt="0 0"
  # shellcheck disable=SC2086 # two words
  "$here/loss_run.sh" "$build" "$input" "$out/$loss" "$loss" $spoilt "$seed" "$@" || echo "the run with $loss % failed" >&2
done
python3 "$here/losses_table.py" "$build" "$out" 0 30 60
