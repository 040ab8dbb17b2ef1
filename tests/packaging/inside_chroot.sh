#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What deb_test.sh does in the chroot, where the packages are in /debs.
set -eu
begin=$(date +%s)
say() { echo "  $(($(date +%s) - begin)) s: $*"; }
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
# Quiet, unless it fails.
quietly() { "$@" >/tmp/said 2>&1 || { cat /tmp/said && fail "$*"; }; }
# Names of all files but of those that apt and dpkg keep for themselves, and Python's caches of what others installed.
files() {
  find / -xdev \( -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log -o -path /tmp -o -path /debs -o \
    -path /root -o -name __pycache__ \) -prune -o -print | sort
}
version=$(dpkg-deb -f /debs/rumi_*.deb Version)

quietly apt-get update -q
quietly apt-get install -y -q --no-install-recommends /debs/rumi_*.deb
say "rumi is installed, $(dpkg-query -W -f '.\n' | wc -l) packages in all"
! command -v cc >/dev/null || fail "there is a compiler"
rumi --version
rumi --version | grep -qx "rumi $version" || fail "not version $version"
rumi --version | grep -q "^commit [0-9a-f]\{7,\}$" || fail "no commit"
rumi --version | grep -q "^libraries: .*OpenCV [0-9]" || fail "no libraries"
cd /tmp
rumi demo -o demo >demo.log 2>&1 || { code=$? && cat demo.log && fail "rumi demo: exit code $code"; }
sed -n '/front alone/,/one map/p' demo.log
grep -q "became one map" demo.log || fail "rumi demo made no map of one piece"
rm -r demo
say "rumi demo"

for file in /etc/rumi/rumi.yaml /etc/rumi/rumi.env; do
  dpkg-query -W -f '${Conffiles}\n' rumi | grep -q "$file" || fail "$file is no conffile"
done
for process in camera_driver front_tracker ruminator map_server viewer_offscreen; do
  rumi $process --config /etc/rumi/rumi.yaml --version | grep -qx "$process $version" || fail "rumi $process is not version $version"
  dpkg -L rumi | grep -q "/man1/rumi-$process.1.gz" || fail "rumi-$process has no man page"
done
dpkg -L rumi | grep -q "^/usr/share/rumi/web/index.html$" || fail "no page for rumi web"
dpkg -L rumi | grep -q "/completions/rumi$" || fail "no completion for bash"
dpkg -L rumi | grep -q "/vendor-completions/_rumi$" || fail "no completion for zsh"
[ -e /usr/lib/systemd/system/rumi.target ] || [ -e /lib/systemd/system/rumi.target ] || fail "no rumi.target"

# Removed: what was configured and mapped stays; purged: nothing does. Without systemd at work, as in an image that is built.
mkdir -p /var/lib/private/rumi
ln -s private/rumi /var/lib/rumi
echo a map >/var/lib/private/rumi/map.db
quietly apt-get remove -y -q rumi
[ "$(dpkg-query -W -f '${db:Status-Status}' rumi)" = config-files ] || fail "removed, rumi is $(dpkg-query -W -f '${db:Status-Status}' rumi)"
[ -s /etc/rumi/rumi.yaml ] || fail "the configuration is gone with remove"
[ -s /var/lib/rumi/map.db ] || fail "the map is gone with remove"
quietly apt-get purge -y -q rumi
rmdir /var/lib/private # systemd's own, which is not at work here
! find / -xdev \( -path /debs -o -path /tmp -o -path /var/log -o -path /root \) -prune -o -iname '*rumi*' -print | grep . ||
  fail "purged, these are left"
say "removed and purged"

# Once more, now that what they depend on is there: exactly what was, is.
quietly apt-get install -y -q --no-install-recommends python3
files >before
quietly apt-get install -y -q --no-install-recommends /debs/rumi_*.deb /debs/python3-rumi-lcmtypes_*.deb
python3 -c 'import rumi; rumi.lcm.EventLog; rumi.track_t' || fail "python3 does not find the types"
quietly dpkg --purge rumi python3-rumi-lcmtypes
files >after
diff before after || fail "purged, the files above came or went"
say "purged, nothing is left"

quietly apt-get install -y -q --no-install-recommends g++ cmake make /debs/librumi-lcmtypes-dev_*.deb
cp -r /usr/share/doc/librumi-lcmtypes-dev/examples /tmp/examples
quietly cmake -S /tmp/examples -B /tmp/listener
quietly cmake --build /tmp/listener
quietly dpkg --purge librumi-lcmtypes-dev
say "an example was built with librumi-lcmtypes-dev"

# For inside_machine.sh, where systemd is at work.
quietly apt-get install -y -q --no-install-recommends systemd udev sqlite3
sort /etc/passwd /etc/group >/srv/accounts
quietly apt-get install -y -q --no-install-recommends /debs/rumi_*.deb
rumi synth -q -o /srv/recording --seconds 3 --size 320x180
say "rumi is installed beside systemd"
