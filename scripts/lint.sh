#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy (checks in .clang-tidy) over the sources and all headers that they include.
#   scripts/lint.sh BUILD_DIR                   what the last forty commits touched, without clang's static analyzer and
#                                               without tests
#   scripts/lint.sh BUILD_DIR all               everything, in the same way: an hour on two cores
#   scripts/lint.sh BUILD_DIR deep [BASE|all]   with the analyzer: what differs from BASE (default: the commit before the
#                                               last), tests included
# The checks are those of Debian 12's clang-tidy; of others there is only a word.
set -eu
build=$1
mode=${2:-recent}
wanted=14
version=$(clang-tidy --version | sed -n 's/.*version \([0-9]*\).*/\1/p' | head -n 1)
if [ "$version" != "$wanted" ]; then
  echo "clang-tidy is of version $version; its checks are not those of version $wanted (Debian 12): nothing is linted"
  exit 0
fi
if [ "$mode" = all ]; then
  set -- --checks=-clang-analyzer-*
  files=$(git ls-files '*.cpp' ':!tests' ':!bench' ':!fuzz')
elif [ "$mode" = recent ]; then
  # The newest first, and no more than a quarter of an hour's: where the history is cut off, all was touched at once.
  set -- '*.cpp' ':!tests' ':!bench' ':!fuzz'
  touched=$(git diff --name-only HEAD -- "$@"; git log -40 --format= --name-only -- "$@")
  files=$(echo "$touched" | awk '!seen[$0]++' | while read -r file; do
    if [ -f "$file" ]; then echo "$file"; fi
  done | head -n 120)
  [ -n "$files" ] || { echo "no source was touched of late"; exit 0; }
  set -- --checks=-clang-analyzer-*
elif [ "${3:-}" = all ]; then
  set --
  files=$(git ls-files '*.cpp')
else
  base=${3:-HEAD~1}
  set --
  files=$( { git diff --name-only --diff-filter=d "$base" -- '*.cpp'; git ls-files --others --exclude-standard '*.cpp'; } | sort -u)
  [ -n "$files" ] || { echo "no source differs from $base"; exit 0; }
fi
# clang cannot read GCC's precompiled headers; without them it also sees which includes were forgotten. Its -Wconversion
# is another one (signs, too): GCC's is the build's.
mkdir -p "$build/lint"
sed -e "s| -Winvalid-pch -include [^ ]*cmake_pch.hxx| -include $PWD/base/eigen_assert.h|" \
  -e 's| -Wconversion -Werror=conversion||' "$build/compile_commands.json" >"$build/lint/compile_commands.json"
echo "clang-tidy of $(echo "$files" | wc -l) files"
echo "$files" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet --warnings-as-errors='*' -p "$build/lint" "$@"
