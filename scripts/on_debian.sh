#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in a clean copy of this checkout on another Debian, in a chroot that debootstrap makes once. As root.
#   scripts/on_debian.sh SUITE [COMMAND...]       SUITE: bookworm, trixie, sid; COMMAND: default `make demo && make test`
# What is committed is what is copied, to /rumi in the chroot; /rumi/build is kept from run to run. The chroot is
# $RUMI_CHROOTS/SUITE (default: /var/tmp/rumi-chroots); remove it to begin anew. Recordings ($RUMI_DATA_DIR, default ../shared/data
# beside the checkout) are there to read as /data. $DEBIAN_MIRROR is another mirror.
set -eu
suite=${1:?which Debian? scripts/on_debian.sh SUITE [COMMAND...]}
shift
[ $# -gt 0 ] || set -- sh -c 'make demo && make test'
here=$(cd "$(dirname "$0")/.." && pwd)
root=${RUMI_CHROOTS:-/var/tmp/rumi-chroots}/$suite
data=${RUMI_DATA_DIR:-$here/../shared/data}
[ "$(id -u)" -eq 0 ] || { echo "error: a chroot needs root: sudo scripts/on_debian.sh $suite" >&2; exit 1; }

"$here/scripts/install_dependencies.sh" debootstrap git util-linux
if [ ! -e "$root/ready" ]; then
  rm -rf "$root"
  mkdir -p "$root"
  debootstrap --variant=minbase --include=ca-certificates,make,git "$suite" "$root" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}"
  touch "$root/ready"
fi
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
mkdir -p "$root/rumi" "$root/data"

# Files that did not change keep their times, so that only what changed is compiled again.
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
git -C "$here" archive HEAD | tar -x -C "$copy"
(cd "$root/rumi" && find . -path ./build\* -prune -o -path ./out -prune -o -type f -print) | while read -r file; do
  [ -e "$copy/$file" ] || rm -f "$root/rumi/$file"
done
(cd "$copy" && find . -type f) | while read -r file; do
  cmp -s "$copy/$file" "$root/rumi/$file" || { mkdir -p "$root/rumi/$(dirname "$file")" && cp -p "$copy/$file" "$root/rumi/$file"; }
done

# debhelper gives compilers an empty home: ccache is told where it keeps what they made.
# A root of its own, not chroot(2): inside that, programs may not make the network namespaces that tests run in.
export root data
unshare --mount --pid --fork --kill-child sh -c '
  set -eu
  mount --make-rprivate /
  mount --bind "$root" "$root"
  if [ -d "$data" ]; then mount --bind -o ro "$data" "$root/data"; fi
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  mount --bind /sys "$root/sys"
  mkdir -p "$root/.before"
  cd "$root"
  pivot_root . .before
  umount -l /.before
  cd /rumi
  exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 RUMI_DATA_DIR=/data \
    CCACHE_DIR=/root/.cache/ccache "$@"' sh "$@"
