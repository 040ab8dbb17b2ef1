#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The sources as they are committed, as a tarball that builds without a network and without git: FOLDER/rumi-VERSION.tar.gz.
#   packaging/make_dist.sh FOLDER
set -eu
folder=${1:?where to? packaging/make_dist.sh FOLDER}
here=$(cd "$(dirname "$0")/.." && pwd)
version=$(sed -n 's/^project(rumi VERSION \([0-9.]*\).*/\1/p' "$here/CMakeLists.txt")
if [ -n "$(git -C "$here" status --porcelain)" ]; then
  echo "What is not committed is not in the tarball." >&2
fi
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
git -C "$here" archive --prefix="rumi-$version/" -o "$folder/rumi-$version.tar.gz" HEAD
echo "$folder/rumi-$version.tar.gz"
