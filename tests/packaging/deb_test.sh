#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The Debian packages: built without a network, looked at by lintian, installed in a clean chroot by one command, used there
# without a compiler, and removed; then again where systemd is at work, in a virtual machine. As root; fetches packages.
#   deb_test.sh SOURCE                       for this Debian; builds in SOURCE/build-deb, as `make deb` does
#   RUMI_SUITE=trixie deb_test.sh SOURCE     for that one; builds in the chroot of scripts/on_debian.sh
# Exit code 77 (CTest: skipped) where something needed is missing. What is kept is in $RUMI_CHROOTS, see scripts/on_debian.sh.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source=$1
suite=${RUMI_SUITE:-}
chroots=${RUMI_CHROOTS:-/var/tmp/rumi-chroots}
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
skip() {
  echo "SKIPPED: $1, so the packages were NOT tested" >&2
  exit 77
}
say() { echo "$(($(date +%s) - begin)) s: $*"; }
begin=$(date +%s)
[ "$(id -u)" -eq 0 ] || skip "a chroot needs root"
for tool in debootstrap dpkg-buildpackage lintian help2man unshare git; do
  command -v $tool >/dev/null || skip "$tool is missing (scripts/install_dependencies.sh --packaging)"
done

# Built, and looked at: WORK/*.deb, WORK/build.log, WORK/lintian.txt.
build='
  work=$1
  unshare --net packaging/make_deb.sh "$work" >"$work.log" 2>&1 || { tail -n 30 "$work.log" && exit 1; }
  mv "$work.log" "$work/build.log"
  lintian --allow-root --fail-on none "$work"/rumi_*.changes >"$work/lintian.txt" 2>&1'
if [ -z "$suite" ]; then
  suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
  debs=$source/build-deb
  (cd "$source" && sh -euc "$build" sh build-deb) || fail "the packages are not built"
else
  debs=$chroots/$suite/rumi/build-deb
  "$source/scripts/on_debian.sh" "$suite" sh -euc "scripts/install_dependencies.sh --packaging && $build" sh build-deb ||
    fail "the packages are not built on $suite"
fi
say "built"
[ ! -s "$debs/lintian.txt" ] || { cat "$debs/lintian.txt" && fail "lintian has something to say"; }
say "lintian says nothing"

clean=$chroots/$suite-clean
if [ ! -e "$clean/ready" ]; then
  rm -rf "$clean"
  mkdir -p "$clean"
  debootstrap --variant=minbase "$suite" "$clean" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$clean.log" 2>&1 ||
    skip "debootstrap does not get $suite (see $clean.log)"
  touch "$clean/ready"
fi
work=$(mktemp -d "$chroots/deb_test.XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT
cp -a "$clean/." "$work"
cp -L /etc/resolv.conf "$work/etc/resolv.conf"
mkdir "$work/debs"
cp "$debs"/*.deb "$here"/inside_*.sh "$here/../virtual_machine/systemd_helpers.sh" "$work/debs/"
say "a clean chroot of $suite"

# All mounts are in a namespace of their own, and end with it.
export work
unshare --mount --pid --fork --kill-child sh -c '
  set -eu
  mount --make-rprivate /
  mount -t proc proc "$work/proc"
  mount --rbind /dev "$work/dev"
  exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    chroot "$work" sh /debs/inside_chroot.sh'
say "installed, used and removed in the chroot"

cd /
RUMI_QEMU_ROOT=$work RUMI_QEMU_TIMEOUT_S=${RUMI_QEMU_TIMEOUT_S:-1200} \
  "$here/../virtual_machine/run_in_qemu.sh" --systemd "$chroots/virtual_machine" sh /debs/inside_machine.sh || exit $?
say "PASSED"
