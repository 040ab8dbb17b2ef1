#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The package under the real systemd in a virtual machine: installed, started, removed while it runs, and purged.
#   systemd_test.sh SOURCE BUILD     runs itself there as root, with --inside; takes the package that deb_test.sh built
# Exit code 77 (CTest: skipped) where something needed is missing. Writes into BUILD/tests/packaging only.
set -eu
if [ "$1" != --inside ]; then
  work=$2/tests/packaging
  deb=$(ls "$1"/build-deb/rumi_*.deb 2>/dev/null) || {
    echo "SKIPPED: there is no package (make deb), so it was NOT run by systemd" >&2
    exit 77
  }
  mkdir -p "$work"
  # The kernel that the test of the units has fetched.
  [ -d "$work/kernel" ] || [ ! -d "$2/tests/virtual_machine/kernel" ] || cp -al "$2/tests/virtual_machine/kernel" "$work/kernel"
  "$2/bin/rumi" synth -q -o "$work/recording" --overwrite --seconds 3 --size 320x180
  RUMI_QEMU_TIMEOUT_S=${RUMI_QEMU_TIMEOUT_S:-850} exec "$1/tests/virtual_machine/run_in_qemu.sh" --systemd "$work" \
    "$1/tests/packaging/systemd_test.sh" --inside "$deb" "$work/recording"
fi
deb=$2
recording=$3
services="rumi-camera-driver rumi-front-tracker rumi-ruminator rumi-viewer rumi-map-server"

say() { echo "$(cut -d . -f 1 /proc/uptime) s: $*"; }
fail() {
  echo "FAILED: $*"
  journalctl --no-pager -o short-monotonic -u 'rumi*'
  exit 1
}
option() { sed -i "s|^  $1: *[^ ]*|  $1: $2|" /etc/rumi/rumi.yaml; }

say "the machine is up"
# What it depends on is installed here, as far as building Rumi wants it.
dpkg --install --force-depends "$deb" >/run/dpkg.log 2>&1 || { cat /run/dpkg.log && fail "dpkg --install"; }
[ "$(systemctl is-enabled rumi.target)" = disabled ] || fail "rumi.target is $(systemctl is-enabled rumi.target) after the installation"
[ "$(systemctl is-active rumi.target $services | sort -u)" = inactive ] || fail "something was started by the installation"
say "installed"

cp -r "$recording" /srv/recording
echo "RUMI_INPUT=/srv/recording" >/etc/rumi/rumi.env
option camera_file /srv/recording/calibration.yaml
option keypoints 300
option loop true
option speed 0.03
systemctl enable --now rumi.target || fail "systemctl enable --now rumi.target"
tries=0
tracked() { [ -f /var/lib/rumi/map.db ] && [ "$(sqlite3 -readonly /var/lib/rumi/map.db 'SELECT count(*) FROM frames WHERE submap >= 0')" -gt 0 ]; }
until tracked; do
  tries=$((tries + 1))
  [ "$tries" -lt 300 ] || fail "no image is tracked"
  sleep 1
done
[ "$(systemctl is-active $services | sort -u)" = active ] || fail "not all are active"
say "all five are active, and images are tracked"

dpkg --remove rumi >/run/dpkg.log 2>&1 || { cat /run/dpkg.log && fail "dpkg --remove"; }
! pgrep -f /usr/libexec/rumi/ || fail "removed, these still run"
tracked || fail "the map is gone with remove"
[ -s /etc/rumi/rumi.env ] || fail "the configuration is gone with remove"
say "removed: nothing runs, and the map is there"

dpkg --purge rumi >/run/dpkg.log 2>&1 || { cat /run/dpkg.log && fail "dpkg --purge"; }
[ ! -e /var/lib/rumi ] && [ ! -L /var/lib/rumi ] && [ ! -e /var/lib/private/rumi ] || fail "the map is there after purge"
for folder in /etc /usr/bin /usr/lib /usr/libexec /usr/share /lib /var; do
  left=$(find $folder -xdev -path /var/tmp -prune -o -path /var/log -prune -o -name '*rumi*' -print)
  [ -z "$left" ] || fail "purged, these are left: $left"
done
say "PASSED"
