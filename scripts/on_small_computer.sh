#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command on one core of this computer and in so much memory, without swap, as root. Says at the end what it took.
#   scripts/on_small_computer.sh MEGABYTES COMMAND ...
# For example, the whole system live at half of the recorded pace:
#   RUMI_LIVE_TRUTH=DATA/redkitchen/groundtruth.txt scripts/on_small_computer.sh 1024 \
#     scripts/live_run.sh build DATA/redkitchen OUT --speed 0.5
# Memory: of all its processes and of the files they write and read; what is on a disk is dropped where it is short.
# Where systemd runs, `systemd-run --scope -p MemoryMax=1G -p MemorySwapMax=0 -p AllowedCPUs=0` does the same.
set -eu
megabytes=${1:?how much memory, in megabytes?}
shift
[ "$(id -u)" -eq 0 ] || { echo "error: limits need root: sudo scripts/on_small_computer.sh" >&2; exit 1; }
if [ -e /sys/fs/cgroup/cgroup.controllers ]; then # version 2, else 1
  group=/sys/fs/cgroup/rumi-small-$$ limit=memory.max peak=memory.peak
  echo +memory >/sys/fs/cgroup/cgroup.subtree_control
else
  group=/sys/fs/cgroup/memory/rumi-small-$$ limit=memory.limit_in_bytes peak=memory.max_usage_in_bytes
fi
mkdir "$group"
trap 'rmdir "$group" 2>/dev/null || true' EXIT
echo "${megabytes}M" >"$group/$limit"
for swap in memory.swap.max memory.memsw.limit_in_bytes; do
  if [ -e "$group/$swap" ]; then
    case $swap in *max) echo 0 ;; *) echo "${megabytes}M" ;; esac >"$group/$swap"
  fi
done
code=0
sh -c 'echo $$ >"$0/cgroup.procs"; exec taskset -c 0 "$@"' "$group" "$@" || code=$?
kills=$(cat "$group/memory.events" "$group/memory.oom_control" 2>/dev/null | sed -n 's/^oom_kill //p')
echo "memory: at most $(($(cat "$group/$peak") / 1000000)) MB of $megabytes MiB; processes that were killed for want of it: ${kills:-not known}"
exit "$code"
