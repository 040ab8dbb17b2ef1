#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# config/rumi.yaml and config/expert.yaml are what the program would write, and mean what it means without them.
#   config_test.sh RUMI CONFIG_FOLDER
set -eu
rumi=$1
folder=$2
defaults=$(mktemp)
trap 'rm -f "$defaults"' EXIT
check() {  # FILE [FLAG]: `rumi config FLAG` writes FILE, and reads it
  "$rumi" config ${2:-} >"$defaults"
  diff -u "$folder/$1" "$defaults" || {
    echo "config/$1 is not up to date: rumi config ${2:-} > config/$1" >&2
    exit 1
  }
  "$rumi" config ${2:-} --config "$folder/$1" | diff -u "$defaults" -
}
check rumi.yaml
check expert.yaml --expert
