#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What a guard is worth: the whole system with an option halved, doubled and, where a value means that, off. Prints a
# Markdown table, a row for each setting beside the defaults (medians and worst changes over recordings and seeds), and
# writes it to OUT/ablation.csv.
#   scripts/ablation.sh BUILD_DIR DATA OUT [OPTION...]
# OPTION: as map_server.min_landmarks; without any, the list in scripts/ablation.py.
# DATA, RUMI_TABLE_RECORDINGS, RUMI_TABLE_SET, RUMI_TABLE_JOBS, RUMI_TABLE_ONLY: see scripts/recordings_table.sh, which
# measures each setting in OUT/OPTION=VALUE, and the defaults in OUT/defaults. What is measured is kept, so that an
# interrupted run can be continued, or one of more options. RUMI_TABLE_SEEDS (1): runs of each. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1
data=$2
out=$3
shift 3
common=${RUMI_TABLE_SET:-}

measure() { # setting, or nothing
  folder=$out/${1:-defaults}
  mkdir -p "$out/sequences" "$folder"
  ln -sfn ../sequences "$folder/sequences" # rendered once for all
  RUMI_TABLE_SET="$common ${1:-}" "$here/recordings_table.sh" "$build" "$data" "$folder" "${RUMI_TABLE_SEEDS:-1}" \
    >"$folder/table.md" || echo "${1:-defaults}: nothing measured" >&2
}

settings=$(python3 -B "$here/ablation.py" settings "$build/bin/rumi" "$@")
for setting in "" $settings; do measure "$setting"; done
# shellcheck disable=SC2086
python3 -B "$here/ablation.py" table "$out" $settings
