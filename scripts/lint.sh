#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# clang-tidy (checks in .clang-tidy) over the sources that differ from BASE (default: the commit before the last), or
# over all of them with `all`, which takes many minutes on two cores.
#   scripts/lint.sh BUILD_DIR [BASE | all]
set -eu
build=$1
base=${2:-HEAD~1}
if [ "$base" = all ]; then
  files=$(git ls-files '*.cpp')
else
  files=$( { git diff --name-only --diff-filter=d "$base" -- '*.cpp'; git ls-files --others --exclude-standard '*.cpp'; } | sort -u)
fi
# clang cannot read GCC's precompiled headers; without them it also sees which includes were forgotten.
mkdir -p "$build/lint"
sed 's| -Winvalid-pch -include [^ ]*cmake_pch.hxx||' "$build/compile_commands.json" >"$build/lint/compile_commands.json"
[ -n "$files" ] || { echo "no source differs from $base"; exit 0; }
echo "$files" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet --warnings-as-errors='*' -p "$build/lint"
