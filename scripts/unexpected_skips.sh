#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Names the tests that were skipped and should have run; 1 if there is one. For machines that have all that tests need.
#   scripts/unexpected_skips.sh EXPECTED LOG...
# EXPECTED: a line each, the name of a test and why it may be skipped. LOG: what ctest said, or Testing/Temporary/LastTest.log.
set -eu
expected=$1
shift
skipped=$(sed -n -e 's/^.*\[  SKIPPED \] \([^ ,]*\) (.*$/\1/p' \
  -e 's/^ *[0-9]*\/[0-9]* Test *#[0-9]*: \([^ ]*\) \.*\*\*\*Skipped.*$/\1/p' "$@" | sort -u)
found=0
for test in $skipped; do
  if ! sed -e '/^#/d' -e 's/ .*//' "$expected" | grep -qxF -e "$test"; then
    echo "skipped, and should have run: $test"
    found=1
  fi
done
exit $found
