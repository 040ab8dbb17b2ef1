#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Draws on a machine that has no OSMesa, and on one that has no OpenGL at all: the libraries are hidden from rumi.
#   opengl_fallback_test.sh RUMI
set -eu
rumi=$1

if [ "${2:-}" != inside ]; then
  if ! unshare --user --map-root-user --mount true 2>/dev/null; then
    echo "SKIPPED: no namespaces here (unshare)"
    exit 77
  fi
  exec unshare --user --map-root-user --mount sh "$0" "$rumi" inside
fi

hide() {  # SONAME; prints how many files of that name there were
  found=0
  for library in $(ldconfig -p 2>/dev/null | sed -n "s/^[[:space:]]*$1 .*=> //p"); do
    mount --bind /dev/null "$(readlink -f "$library")"
    found=$((found + 1))
  done
  echo "$found"
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
PATH=$PATH:/sbin:/usr/sbin
draw() { "$rumi" synth -o "$work/$1" --seconds 0.1 --size 64x48 -q 2> "$work/$1.err"; }

draw all || { cat "$work/all.err"; exit 1; }
if [ "$(hide libOSMesa.so.8)" = 0 ] || ! RUMI_OPENGL=egl draw egl; then
  echo "SKIPPED: this machine does not have both OSMesa and EGL"
  exit 77
fi
draw without_osmesa || { echo "does not fall back to EGL:"; cat "$work/without_osmesa.err"; exit 1; }
if RUMI_OPENGL=osmesa draw osmesa; then echo "OSMesa was not hidden"; exit 1; fi
hide libEGL.so.1 > /dev/null
if draw nothing; then echo "draws without OpenGL"; exit 1; fi
grep -q "no OpenGL: .*libOSMesa.*libEGL" "$work/nothing.err" || { echo "does not say why:"; cat "$work/nothing.err"; exit 1; }
