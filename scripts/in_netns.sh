# shellcheck shell=sh disable=SC2154 # here: the script that reads it sets it
# SPDX-License-Identifier: BSD-3-Clause
# Read by a script (.) with its own folder's parent in $here and its arguments as they came: from here on it runs in a
# network of its own (tests/run_in_netns.sh), with a folder for its files, $work. What is listed in $pids ends with it.
[ "${RUMI_IN_NETNS:-}" = 1 ] || exec "$here/tests/run_in_netns.sh" "$0" "$@"
work=$(mktemp -d)
pids=""
cleanup() {
  for pid in $pids; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap cleanup EXIT
