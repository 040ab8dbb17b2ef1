#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Debian packages of what is committed, built from the tarball of packaging/make_dist.sh: WORK/*.deb. WORK is made anew.
#   packaging/make_deb.sh WORK [JOBS]
# Their maintainer is $DEBFULLNAME <$DEBEMAIL>.
set -eu
work=${1:?where to? packaging/make_deb.sh WORK [JOBS]}
jobs=${2:-$(nproc)}
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$work"
tarball=$("$here/make_dist.sh" "$work")
tar -xf "$tarball" -C "$work"
source=${tarball%.tar.gz}
cp -r "$source/packaging/debian" "$source/debian"

if [ -n "${DEBEMAIL:-}" ]; then
  maintainer="${DEBFULLNAME:-The Rumi authors} <$DEBEMAIL>"
  sed -i "s/^Maintainer: .*/Maintainer: $(echo "$maintainer" | sed 's/[&\/]/\\&/g')/" "$source/debian/control"
else
  maintainer=$(sed -n 's/^Maintainer: //p' "$source/debian/control")
  echo "The packages' maintainer is $maintainer, which is nobody's address: DEBFULLNAME and DEBEMAIL name another." >&2
fi

# The version stands in CMakeLists.txt, the date is that of the commit.
version=${source##*/rumi-}
cat >"$source/debian/changelog" <<END
rumi ($version) unstable; urgency=medium

  * /usr/share/doc/rumi/CHANGELOG.md tells what is new.

 -- $maintainer  $(date -u -R -d "$(cut -d' ' -f2 "$source/packaging/commit.txt")")
END
cd "$source"
dpkg-buildpackage -b -us -uc -j"$jobs"
rm -r "$source"
