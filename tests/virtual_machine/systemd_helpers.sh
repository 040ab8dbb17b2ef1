# SPDX-License-Identifier: BSD-3-Clause
# For the scripts that run under systemd in the virtual machine: what is said, waited for and asked. Below $prefix
# Rumi is installed.
services="rumi-camera-driver rumi-front-tracker rumi-ruminator rumi-viewer rumi-map-server"
map=/var/lib/rumi/map.db
limit_s=300  # it only ends what hangs: the machine is emulated, and may be busy

slow=/run/systemd/system/rumi-.service.d

uptime_s() { cut -d . -f 1 /proc/uptime; }
say() { echo "$(uptime_s) s: $*"; }
fail() {
  echo "FAILED: $*"
  journalctl --no-pager -o short-monotonic -u 'rumi*'
  systemctl status --no-pager -n 0 $services || true
  if [ -f /run/status ]; then tail -n 1 /run/status; fi
  exit 1
}
wait_for() { # WHAT COMMAND...: until the command succeeds
  what=$1
  shift
  end=$(($(uptime_s) + limit_s))
  until "$@"; do
    [ "$(uptime_s)" -lt "$end" ] || fail "not within $limit_s s: $what"
    sleep 1
  done
  say "$what"
}

of_all() { echo $(systemctl show -P "$1" $services); }
all_are() { [ "$(systemctl is-active $services | sort -u)" = "$1" ]; }
query() { sqlite3 -readonly "$map" "$1"; }
# Frames by their number: the recording begins at 1000 s and has 30 Hz.
number="(utime - 1000000000 + 16666) * 30 / 1000000"
is_tracked_up_to() { [ -f "$map" ] && [ "$(query "SELECT ifnull(max($number), -1) FROM frames WHERE submap >= 0")" -ge "$1" ]; }
option() { sed -i "s|^  $1: *[^ ]*|  $1: $2|" /etc/rumi/rumi.yaml; }
configure() { # INPUT: as it was installed, but so little that the machine can do it
  cp "$prefix/share/rumi/config/rumi.yaml" /etc/rumi/
  option camera_file /srv/recording/calibration.yaml
  option keypoints 300
  option init_keypoints 600
  option interval_s 60
  echo "RUMI_INPUT=$1" >/etc/rumi/rumi.env
  mkdir -p $slow
  printf '[Service]\nTimeoutStopSec=%s\n' $limit_s >$slow/slow.conf # what is open is still done, here in more than 60 s
}
