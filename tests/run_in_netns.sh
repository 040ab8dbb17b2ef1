#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# run_in_netns.sh COMMAND ARGS...: runs a command in a network of its own in which LCM multicast works, so that tests
# neither hear one another nor disturb anybody. Needs no root. Exit code 77 (CTest: skipped) where the kernel forbids it.
if [ "$RUMI_IN_NETNS" != 1 ]; then
  if ! unshare -rn true 2>/dev/null; then
    echo "SKIPPED: user namespaces are not permitted here, so this LCM test was NOT run: $*" >&2
    echo "Allow them with: sudo sysctl -w kernel.unprivileged_userns_clone=1" >&2
    exit 77
  fi
  RUMI_IN_NETNS=1 exec unshare -rn "$0" "$@"
fi
set -e
ip link set lo up
ip link set lo multicast on
ip route add 239.255.76.67/32 dev lo
exec "$@"
