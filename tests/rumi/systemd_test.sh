#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What docs/installing.md says of systemd, done as it says, with the real systemd in a virtual machine: Rumi is
# installed, started, killed, stopped, started with a camera, and with a config that is wrong.
#   systemd_test.sh SOURCE BUILD     runs itself there as root, with --inside
# Exit code 77 (CTest: skipped) where something needed is missing. Writes into BUILD/tests/virtual_machine only.
set -eu
if [ "$1" != --inside ]; then
  work=$2/tests/virtual_machine
  command -v sqlite3 >/dev/null || {
    echo "SKIPPED: sqlite3 is missing (scripts/install_dependencies.sh sqlite3), so config/systemd was NOT run by systemd" >&2
    exit 77
  }
  mkdir -p "$work"
  "$2/bin/rumi" synth -q -o "$work/recording" --overwrite --seconds 3 --size 320x180 # a size that vivid has too
  RUMI_QEMU_TIMEOUT_S=${RUMI_QEMU_TIMEOUT_S:-850} exec "$1/tests/virtual_machine/run_in_qemu.sh" --systemd "$work" \
    "$1/tests/rumi/systemd_test.sh" --inside "$2"
fi
build=$2
prefix=/usr/local
. "$(dirname "$0")/../virtual_machine/systemd_helpers.sh"

# /run/status has a line of JSON for each second.
status() { # PATH, as in tracking.frames
  tail -n 1 /run/status >/run/last_status
  sqlite3 :memory: "SELECT json_extract(CAST(readfile('/run/last_status') AS TEXT), '\$.$1')"
}
five_run() { [ "$(tail -n 1 /run/status | grep -o '"state":"running"' | wc -l)" -eq 5 ]; }
listen() {
  rumi status --json --follow >/run/status 2>&1 &
  listener=$!
}
published() { status processes.camera_driver.detail | sed 's/ images.*//'; }

say "the machine is up"
cmake --install "$build" --prefix $prefix >/run/install.log || { cat /run/install.log && fail "cmake --install"; }
mkdir -p /etc/rumi
cp -r "$build/tests/virtual_machine/recording" /srv/recording
configure /srv/recording
option loop true
option speed 0.03
systemctl daemon-reload
say "installed"
systemctl enable --now rumi.target || fail "systemctl enable --now rumi.target"
[ -L /etc/systemd/system/multi-user.target.wants/rumi.target ] || fail "it would not be started at boot"
listen
wait_for "all five are active" all_are active
wait_for "all five say that they run" five_run
wait_for "images are tracked" is_tracked_up_to 0
[ -d /var/lib/rumi/rumi-spool ] || fail "there is no spool in /var/lib/rumi"
for pid in $(of_all MainPID); do
  [ "$(stat -c %u "/proc/$pid")" -ne 0 ] || fail "$(cat "/proc/$pid/comm") runs as root"
done

# Who is killed is started again, and what the map had is there.
is_restarted() { [ "$(systemctl show -P NRestarts "$1")" -eq 1 ] && [ "$(systemctl is-active "$1")" = active ]; }
for service in rumi-map-server rumi-front-tracker; do
  query 'SELECT utime FROM frames' | sort >/run/known
  kill -9 "$(systemctl show -P MainPID $service)"
  wait_for "$service was killed and is started again" is_restarted $service
  wait_for "images taken since then are tracked" is_tracked_up_to $(($(published) + 10)) # the status is of a while ago
  query 'SELECT utime FROM frames' | sort | comm -23 /run/known - >/run/lost
  [ ! -s /run/lost ] || fail "$(wc -l </run/lost) frames of the map are lost since $service was killed"
done

# Stopped: the camera first and the map last, so that nothing is lost on the way.
systemctl stop rumi.target || fail "systemctl stop rumi.target"
wait_for "all five have stopped" all_are inactive
results=$(of_all Result)
[ "$results" = "success success success success success" ] || fail "$services ended with: $results"
ended=$(of_all InactiveEnterTimestampMonotonic)
asked=$(of_all ActiveExitTimestampMonotonic) # to end
echo "$ended $asked" | awk '{ for (i = 2; i <= 4; ++i) if ($(5 + i) < $1 || $10 < $i) exit 1 }' ||
  fail "not in order: $services were asked to end at $asked us, and ended at $ended us"
last_is_there() { [ "$(query "SELECT max($number) + 1 FROM frames")" -eq "$(published)" ]; }
wait_for "the camera's last image is in the map" last_is_there
told=$(status tracking.frames)
stored=$(query 'SELECT count(*) FROM frames WHERE session = (SELECT max(session) FROM frames)')
[ "$told" -eq "$stored" ] || fail "front_tracker told of $told frames since it was started again, the map has $stored"

# A camera.
kill "$listener"
configure /dev/video0
option rate 5
systemctl start rumi.target || fail "systemctl start rumi.target"
listen
images_flow() { status tracking.rate_hz | grep -q '[1-9]'; }
wait_for "the camera's images flow" images_flow
pid=$(systemctl show -P MainPID rumi-camera-driver)
grep -q '^Uid:.*[[:space:]]0' "/proc/$pid/status" && fail "camera_driver runs as root"
grep -q "^Groups:.*[[:space:]]$(stat -c %g /dev/video0)\b" "/proc/$pid/status" || fail "camera_driver is not in the camera's group"
option controls '"brightness=77"'
systemctl reload rumi-camera-driver || fail "systemctl reload rumi-camera-driver"
is_bright() { v4l2-ctl -d /dev/video0 -C brightness | grep -q ' 77$'; }
wait_for "reloaded, the camera has its new brightness" is_bright
[ "$(systemctl show -P MainPID rumi-camera-driver)" -eq "$pid" ] || fail "camera_driver was started again instead of reloaded"

# A config that cannot be used is a failure for good, and nobody else's.
option speed nonsense
systemctl restart rumi-camera-driver || true
has_failed() { [ "$(systemctl is-active rumi-camera-driver)" = failed ]; }
wait_for "with a wrong config camera_driver fails" has_failed
[ "$(systemctl show -P ExecMainStatus rumi-camera-driver)" -eq 2 ] || fail "exit code $(systemctl show -P ExecMainStatus rumi-camera-driver), not 2"
[ "$(systemctl show -P NRestarts rumi-camera-driver)" -eq 0 ] || fail "a wrong config was tried again"
say "PASSED"
