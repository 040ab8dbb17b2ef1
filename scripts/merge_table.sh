#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's Table IV on rendered sequences: the one map that front and back submaps make, with and without
# post-culling, and what there is with the front alone. Replays sequences along true camera paths with a passage that is
# hard, and writes a Markdown table to the terminal and OUT/merge_table.csv, OUT/merge_runs.csv.
#   scripts/merge_table.sh BUILD_DIR TRAJECTORIES OUT [RUNS]
# The arguments, the sequences, their choice by RUMI_TABLE_SEQUENCES and RUMI_TABLE_KINDS, and OUT/*/sequence and
# OUT/*/front are those of scripts/back_process_table.sh: in the same OUT nothing is rendered twice. What exists in OUT is
# kept, so that an interrupted run can be continued; remove OUT/*/culled and OUT/*/kept to measure again.
# RUMI_TABLE_ONLY=1: the table of what exists. Needs python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/rendered_runs.sh"

measure() { # folder
  replay "$1" front ruminator.rebuild=false
  replay "$1" culled map_server.cull_back_keyframes=true
  replay "$1" kept map_server.cull_back_keyframes=false
}

measure_all
python3 -B "$here/merge_table.py" "$out"
