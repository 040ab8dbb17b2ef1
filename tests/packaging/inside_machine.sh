#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What deb_test.sh does in the virtual machine, where the package rumi is installed and systemd is at work: the units are
# started as docs/installing.md says, on a recording in /srv; then the package is removed and purged.
# /srv/accounts has the users and groups of before.
set -eu
prefix=/usr
. /debs/systemd_helpers.sh

say "the machine is up"
[ "$(systemctl is-enabled rumi.target || true)" = disabled ] || fail "nobody enabled rumi.target, but it is $(systemctl is-enabled rumi.target)"
all_are inactive || fail "nobody started them, but they are: $(systemctl is-active $services)"
configure /srv/recording
option speed 0.01
systemctl daemon-reload
systemctl enable --now rumi.target || fail "systemctl enable --now rumi.target"
[ -L /etc/systemd/system/multi-user.target.wants/rumi.target ] || fail "it would not be started at boot"
wait_for "all five are active" all_are active
wait_for "images are tracked" is_tracked_up_to 0
for pid in $(of_all MainPID); do
  [ "$(stat -c %u "/proc/$pid")" -ne 0 ] || fail "$(cat "/proc/$pid/comm") runs as root"
done
frames_before=$(query 'SELECT count(*) FROM frames')

dpkg --remove rumi >/run/said 2>&1 || { cat /run/said && fail "dpkg --remove rumi"; }
say "the package is removed"
rm -r $slow && systemctl daemon-reload
for service in $services; do
  [ "$(systemctl show -P LoadState $service)" = not-found ] || fail "$service is known, without the package"
  ! systemctl is-active -q $service || fail "$service still runs"
done
journalctl --no-pager -u 'rumi*' | grep -E "Failed with result|Main process exited, code=(killed|dumped)" && fail "they did not end well"
[ "$(query 'SELECT count(*) FROM frames')" -ge "$frames_before" ] || fail "the map has lost frames with remove"
[ -d /var/lib/rumi/rumi-spool ] || fail "the spool is gone with remove"
grep -q /srv/recording /etc/rumi/rumi.env || fail "the configuration is gone with remove"

dpkg --purge rumi >/run/said 2>&1 || { cat /run/said && fail "dpkg --purge rumi"; }
say "the package is purged"
! find / -xdev \( -path /debs -o -path /srv -o -path /proc -o -path /sys -o -path /run -o -path /var/log \) -prune -o -iname '*rumi*' -print |
  grep . || fail "purged, these are left"
! find /etc/systemd /run/systemd -iname '*rumi*' | grep . || fail "purged, systemd has these"
sort /etc/passwd /etc/group | diff /srv/accounts - || fail "purged, the users and groups above came or went"
! getent passwd rumi || fail "purged, there is a user rumi"
say "PASSED"
