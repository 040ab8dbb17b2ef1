#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The sources as a tarball that builds without a network and without git: FOLDER/rumi-VERSION.tar.gz. They are those that are
# committed; where there is no git, because this is such a tarball, they are what it has.
#   packaging/make_dist.sh FOLDER
set -eu
folder=${1:?where to? packaging/make_dist.sh FOLDER}
here=$(cd "$(dirname "$0")/.." && pwd)
name=rumi-$(sed -n 's/^project(rumi VERSION \([0-9.]*\).*/\1/p' "$here/CMakeLists.txt")
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
tarball=$folder/$name.tar.gz
if [ -e "$here/.git" ]; then
  if [ -n "$(git -C "$here" status --porcelain)" ]; then
    echo "What is not committed is not in the tarball." >&2
  fi
  git -C "$here" archive --prefix="$name/" -o "$tarball" HEAD
else
  # Without what `make` makes.
  tar -czf "$tarball" -C "$here" --exclude='./build*' --exclude=./out --transform="s|^\.|$name|" .
fi
echo "$tarball"
