#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The Debian packages: built without a network, looked at by lintian, installed in a clean chroot of this Debian by one
# command, used there without a compiler, and removed. As root; fetches packages.
#   deb_test.sh SOURCE        builds in SOURCE/build-deb, as `make deb` does
#   RUMI_SUITE=trixie deb_test.sh SOURCE DEBS      takes the packages in DEBS and installs them in that Debian
# Exit code 77 (CTest: skipped) where something needed is missing. $RUMI_CHROOTS/SUITE-clean is kept, see scripts/on_debian.sh.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source=$1
debs=${2:-$source/build-deb}
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
suite=${RUMI_SUITE:-$(. /etc/os-release && echo "$VERSION_CODENAME")}

if [ $# -eq 1 ]; then
  mkdir -p "$debs"
  unshare --net "$source/packaging/make_deb.sh" "$debs" >"$debs.log" 2>&1 || { tail -n 30 "$debs.log" && fail "make_deb.sh"; }
  mv "$debs.log" "$debs/build.log"
  say "built"
  lintian --allow-root --fail-on none "$debs"/rumi_*.changes >"$debs/lintian.txt" 2>&1 || true
  [ ! -s "$debs/lintian.txt" ] || { cat "$debs/lintian.txt" && fail "lintian has something to say"; }
  say "lintian says nothing"
fi

clean=${RUMI_CHROOTS:-/var/tmp/rumi-chroots}/$suite-clean
if [ ! -e "$clean/ready" ]; then
  rm -rf "$clean"
  mkdir -p "$clean"
  debootstrap --variant=minbase "$suite" "$clean" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$clean.log" 2>&1 ||
    skip "debootstrap does not get $suite (see $clean.log)"
  touch "$clean/ready"
fi
work=$(mktemp -d "${RUMI_CHROOTS:-/var/tmp/rumi-chroots}/deb_test.XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT
cp -a "$clean/." "$work"
cp -L /etc/resolv.conf "$work/etc/resolv.conf"
mkdir "$work/debs"
cp "$debs"/*.deb "$here/inside_chroot.sh" "$work/debs/"
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
say "PASSED"
