#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What is lost, and what comes back, when a recording is damaged for a moment: makes damaged copies of a TUM-style
# sequence of JPEG images, replays each with and without rebuilding, and prints a table (also OUT/table.csv).
#   scripts/damaged_sequences.sh BUILD_DIR SEQUENCE OUT [DAMAGE ...]
# DAMAGE: every6:BEGIN:SECONDS (only every 6th frame), black:BEGIN:SECONDS (lens covered) or blur12:BEGIN:SECONDS (out of
# focus by 12 px); BEGIN in seconds after the first frame. Any other number in place of 6 and 12 will do. Without any:
# what suits 7-Scenes' redkitchen. Needs ImageMagick (RUMI_CONVERT: its convert), jq and awk. Results that exist are kept.
set -eu
build=$1
sequence=$(realpath "$2")
out=$3
shift 3
# It turns by 20 degrees per second at 5 and at 24.5 s, and hardly at 10 s.
[ $# -gt 0 ] || set -- every6:5:2 black:10:1 black:24.5:1 blur12:24.5:1
mkdir -p "$out"
out=$(realpath "$out")
rumi=$build/bin/rumi
convert=${RUMI_CONVERT:-convert}

# Prints rgb.txt with the frames of the passage left out ("drop") or their file names alone ("list").
passage() { # what begin seconds every
  awk -v what="$1" -v begin="$2" -v length_s="$3" -v every="${4:-1}" '
    /^#/ || NF < 2 { if (what == "drop") print; next }
    !seen++ { first = $1 }
    { t = $1 - first; inside = t >= begin - 1e-6 && t < begin + length_s - 1e-6 }
    what == "list" { if (inside) print $2; next }
    !inside || n++ % every == 0 { print }' "$sequence/rgb.txt"
}

damage() { # DAMAGE folder
  kind=${1%%:*}
  begin=$(echo "$1" | cut -d: -f2)
  length=$(echo "$1" | cut -d: -f3)
  mkdir -p "$2/rgb"
  cp "$sequence/calibration.yaml" "$sequence/groundtruth.txt" "$2"
  cp "$sequence/rgb.txt" "$2/rgb.txt"
  awk '!/^#/ && NF >= 2 { print $2 }' "$sequence/rgb.txt" | while read -r image; do
    ln -sf "$sequence/$image" "$2/$image"
  done
  case $kind in
    every*) passage drop "$begin" "$length" "${kind#every}" >"$2/rgb.txt" ;;
    black | blur*)
      passage list "$begin" "$length" | while read -r image; do
        rm "$2/$image"
        case $kind in
          # A sensor in the dark is noise, not zeros.
          black) "$convert" "$sequence/$image" -evaluate multiply 0 -seed 1 -attenuate 0.1 +noise Gaussian "$2/$image" ;;
          blur*) "$convert" "$sequence/$image" -blur "0x${kind#blur}" "$2/$image" ;;
        esac
      done
      ;;
    *)
      echo "$kind: must be every<N>, black or blur<PX>" >&2
      exit 2
      ;;
  esac
}

ratio() { # OUT folder of a replay, the whole recording
  "$rumi" evaluate "$1" --groundtruth "$sequence/groundtruth.txt" --json >"$1/evaluation.json" ||
    [ -s "$1/evaluation.json" ]
}

echo "damage,frames,windows,front_tracked_ratio,front_submap_ratio,tracked_ratio,ate_m,window,gap_frames,sampled,registered,ate_window_m,path_m,cpu_s,failure" >"$out/table.csv"
for damage in "$@"; do
  folder=$out/$(echo "$damage" | tr : _)
  if [ ! -e "$folder/made" ]; then
    damage "$damage" "$folder/sequence"
    touch "$folder/made"
  fi
  for rebuild in false true; do
    run=$folder/rebuild_$rebuild
    [ -e "$run/evaluation.json" ] && continue
    "$rumi" replay -q "$folder/sequence" -o "$run" --set "ruminator.rebuild=$rebuild" ||
      [ $? -eq 3 ] # what tracked nothing is measured, too
    ratio "$run"
  done
  front=$folder/rebuild_false back=$folder/rebuild_true
  [ -e "$back/windows.jsonl" ] || "$rumi" ruminate -q "$back/windows" --truth "$sequence/groundtruth.txt" --json \
    -o "$back/rebuilt" >"$back/windows.jsonl.part" 2>"$back/ruminate.log" || true
  [ ! -e "$back/windows.jsonl.part" ] || mv "$back/windows.jsonl.part" "$back/windows.jsonl"
  jq -rn --arg damage "$damage" --slurpfile f "$front/evaluation.json" --slurpfile b "$back/evaluation.json" \
    --slurpfile w "$back/windows.jsonl" '
    ($w | if length == 0 then [{}] else . end)[] as $row |
    [$damage, $f[0].frames, ($w | length), $f[0].tracked_frame_ratio, $f[0].submap_frame_ratio,
     $b[0].tracked_frame_ratio, $b[0].ate_rmse_m, $row.window, $row.gap, ($row.approach // 0) + ($row.gap // 0) +
     ($row.departure // 0), ($row.registered_approach // 0) + ($row.registered_gap // 0) +
     ($row.registered_departure // 0), $row.ate_m, $row.path_m, $row.cpu_s, $row.failure] | @csv' >>"$out/table.csv"
  jq -rn --arg damage "$damage" --slurpfile f "$front/evaluation.json" --slurpfile b "$back/evaluation.json" \
    --slurpfile w "$back/windows.jsonl" '
    def percent: if . == null then "-" else "\(. * 1000 | round / 10) %" end;
    def metres: if . == null then "-" else "\(. * 10000 | round / 10000) m" end;
    "\($damage)  \($f[0].frames) frames | map \($f[0].tracked_frame_ratio | percent), any submap \($f[0].submap_frame_ratio | percent), ATE \($f[0].ate_rmse_m | metres) | map \($b[0].tracked_frame_ratio | percent), any submap \($b[0].submap_frame_ratio | percent), ATE \($b[0].ate_rmse_m | metres)",
    ($w[] | "    window \(.window): \(.registered_approach)/\(.approach) + \(.registered_gap)/\(.gap) + \(.registered_departure)/\(.departure) frames, \(if .built then "ATE \(.ate_m | metres) of \(.path_m | metres)" else "failed: \(.failure)" end), \(.cpu_s * 10 | round / 10) CPU s")'
done
