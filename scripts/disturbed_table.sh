#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What things in the image that are not the world do to the whole system: plays recordings with a truth as they are and
# with each disturbance of disturbed_recordings.py, and prints a Markdown table of errors and frames beside those of the
# recording as it is.
#   scripts/disturbed_table.sh BUILD_DIR DATA OUT [SEEDS]
# DATA, OUT, SEEDS and RUMI_TABLE_JOBS as for recordings_table.sh. RUMI_DISTURBED="NAME ...": these recordings;
# RUMI_DISTURBANCES="KIND ...": these disturbances. Needs python3 and python3-opencv.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
recordings=${RUMI_DISTURBED:-redkitchen hololens v1_03_rendered kitti00_416 kitti_drive_268 sfm_castle_p30}
kinds=${RUMI_DISTURBANCES:-$(python3 -B "$here/disturbances.py")}
names=
for recording in $recordings; do
  names="$names $recording"
  for kind in $kinds; do names="$names ${kind}_$recording"; done
done
RUMI_TABLE_RECORDINGS=$names "$here/recordings_table.sh" "$1" "$2" "$3" "${4:-1}" >/dev/null
python3 -B "$here/disturbed_table.py" "$3"
