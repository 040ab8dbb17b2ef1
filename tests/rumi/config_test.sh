#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# config/rumi.yaml is what the program would write, and means what the program means without it.
#   config_test.sh RUMI CONFIG
set -eu
rumi=$1
config=$2
defaults=$(mktemp)
trap 'rm -f "$defaults"' EXIT
"$rumi" config >"$defaults"
diff -u "$config" "$defaults" || {
  echo "config/rumi.yaml is not up to date: rumi config > config/rumi.yaml" >&2
  exit 1
}
"$rumi" config --config "$config" | diff -u "$defaults" -
