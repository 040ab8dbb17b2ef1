# SPDX-License-Identifier: BSD-3-Clause
# For scripts that measure rendered sequences with a hard passage, to be sourced with their arguments: BUILD_DIR
# TRAJECTORIES OUT [RUNS], and RUMI_TABLE_SEQUENCES, RUMI_TABLE_KINDS, RUMI_TABLE_ONLY (see back_process_table.sh).
rumi=$1/bin/rumi
trajectories=$2
out=$3
runs=${4:-3}
# The passages fall on the faster turns of these paths.
sequences=${RUMI_TABLE_SEQUENCES:-fr1_room:2 fr3_teddy:46 V102:36 icl_living_room_t2:6}
kinds=${RUMI_TABLE_KINDS:-blur dark textureless rotation}
length=12 begin=5 passage=2 # seconds
mkdir -p "$out"

# Leaves its folder in $folder: $folder/sequence is the rendering.
render() { # sequence start kind seed
  folder=$out/$1_$3_$4
  mkdir -p "$folder"
  if [ ! -e "$folder/rendered" ]; then
    "$rumi" synth -q --overwrite -o "$folder/sequence" --path "$trajectories/$1.txt" --start "$2" --duration $length \
      --seed "$4" --hard "$3" --at $begin --for $passage
    touch "$folder/rendered"
  fi
}

replay() { # folder name option: the run and its evaluation in folder/name
  if [ -e "$1/$2/evaluation.json" ]; then return; fi
  "$rumi" replay -q "$1/sequence" -o "$1/$2" --set "$3" || [ $? -eq 3 ]
  "$rumi" evaluate "$1/$2" --groundtruth "$1/sequence/groundtruth.txt" --json >"$1/$2/evaluation.json.part" ||
    [ -s "$1/$2/evaluation.json.part" ]
  mv "$1/$2/evaluation.json.part" "$1/$2/evaluation.json"
}

# Calls `measure` with the folder of each rendering, run by run, so that what is there after an interruption compares.
measure_all() {
  [ -z "${RUMI_TABLE_ONLY:-}" ] || return 0
  for seed in $(seq "$runs"); do
    for sequence in $sequences; do
      for kind in $kinds; do
        render "${sequence%%:*}" "${sequence##*:}" "$kind" "$seed"
        measure "$folder"
      done
    done
  done
}
