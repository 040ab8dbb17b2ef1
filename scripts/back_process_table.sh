#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's Table III on rendered sequences: what the front process has without the back process, what the back
# process adds, and what it costs. Renders sequences along true camera paths with a passage that is hard, replays each
# with the front alone, rebuilds the windows it announced, and writes a Markdown table to the terminal and
# OUT/table.csv, OUT/runs.csv.
#   scripts/back_process_table.sh BUILD_DIR TRAJECTORIES OUT [RUNS]
# TRAJECTORIES: folder of TUM files (t tx ty tz qx qy qz qw). RUNS (3): renderings of each sequence, each with a room and
# noise of its own. What exists in OUT is kept, so that an interrupted run can be continued; remove OUT/*/front or
# OUT/*/back to measure again without rendering again.
# RUMI_TABLE_SEQUENCES="NAME:START ...": other paths, and where on them to begin, s. RUMI_TABLE_KINDS: other passages.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/rendered_runs.sh"

measure() { # folder
  replay "$1" front ruminator.rebuild=false
  if [ ! -e "$1/back/windows.jsonl" ]; then
    mkdir -p "$1/back"
    : >"$1/back/part"
    # A window that cannot be rebuilt is a result too.
    if ls "$1"/front/windows/*.window >/dev/null 2>&1; then
      "$rumi" ruminate -q "$1/front/windows" -o "$1/back" --truth "$1/sequence/groundtruth.txt" --json \
        >"$1/back/part" 2>"$1/back/log" || true
    fi
    mv "$1/back/part" "$1/back/windows.jsonl"
  fi
}

measure_all
python3 -B "$here/back_process_table.py" "$out"
