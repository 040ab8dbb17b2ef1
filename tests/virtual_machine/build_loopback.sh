#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# build_loopback.sh WORK VERSION: makes WORK/v4l2loopback-VERSION.ko, the virtual camera that a program feeds (vivid has no
# MJPEG), for Debian's kernel of this version. Headers and source are fetched into WORK (14 MB), and not installed.
set -eu
work=$(cd "$1" && pwd)
version=$2
module=$work/v4l2loopback-$version.ko
[ ! -f "$module" ] || exit 0

parts=$work/loopback.part
rm -rf "$parts"
mkdir -p "$parts"
cd "$parts"
echo "fetching the headers of $version and v4l2loopback (14 MB)"
headers=$(apt-cache depends "linux-headers-$version" 2>/dev/null | awk '/Depends: linux-(headers|kbuild)-/ {print $2}')
[ -n "$headers" ] || { echo "apt knows no linux-headers-$version; without $work a newer kernel is fetched" >&2; exit 1; }
timeout 300 apt-get download -q "linux-headers-$version" $headers v4l2loopback-dkms
for package in *.deb; do dpkg-deb -x "$package" root; done
# Debian's headers know where they would be installed.
sed -i "s|include /usr/src|include $parts/root/usr/src|" "root/usr/src/linux-headers-$version/Makefile"
make -s -C "root/usr/src/linux-headers-$version" M="$(echo "$parts"/root/usr/src/v4l2loopback-*)" modules
mv root/usr/src/v4l2loopback-*/v4l2loopback.ko "$module"
rm -rf "$parts"
