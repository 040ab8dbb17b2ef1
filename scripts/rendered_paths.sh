# SPDX-License-Identifier: BSD-3-Clause
# Sequences along true camera paths, for scripts that render them, to be sourced. They set $rumi and $trajectories, the
# folder of TUM files (t tx ty tz qx qy qz qw).

# NAME:START, where on each path the sequence begins, s.
rendered_paths="fr1_room:2 fr1_floor:4 fr1_teddy:4 fr2_desk:10 fr2_pioneer_slam:20 fr3_teddy:40
  V102:20 V103:20 V203:20 icl_living_room_t0:4 icl_living_room_t1:4 icl_living_room_t2:4 icl_living_room_t3:4
  icl_office_t0:4 icl_office_t1:4 icl_office_t2:4 icl_office_t3:4"
passage=1.5 # seconds

# plain: 12 s as it is. hard: 20 s with a passage of each kind. Else 12 s with a passage of that kind.
how_rendered() { # kind
  case $1 in
    plain) echo --duration 12 ;;
    hard) echo "--duration 20 --hard blur --at 5 --for $passage --hard dark --at 9 --for $passage" \
      "--hard textureless --at 13 --for $passage --hard rotation --at 17 --for $passage" ;;
    *) echo "--duration 12 --hard $1 --at 5 --for $passage" ;;
  esac
}

render_path() { # folder NAME:START kind
  # shellcheck disable=SC2046
  "$rumi" synth -q --overwrite -o "$1" --path "$trajectories/${2%%:*}.txt" --start "${2##*:}" $(how_rendered "$3")
}

# A drive along a path of KITTI, or `campus`, a robot's round. hardstreet: with three passages in which tracking is lost.
render_street() { # folder street|hardstreet NAME
  how="--path $trajectories/kitti/$3.txt"
  if [ "$3" = campus ]; then how="--walk campus --seconds 735 --rate 15"; fi
  if [ "$2" = hardstreet ]; then how="$how --hard dark --at 60 --for 3 --hard blur --at 140 --for 3 --hard lorry --at 200 --for 3"; fi
  # shellcheck disable=SC2086
  "$rumi" synth -q --overwrite -o "$1" --scene street $how
}
