#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian packages that Rumi needs and that are missing; does nothing, and needs no rights, when none is.
#   scripts/install_dependencies.sh [--check] [--packaging] [PACKAGE...]
# --check only tells. Wanted besides: with --packaging what makes packages of Rumi and tests them, and the PACKAGEs.
set -eu

packages="build-essential cmake ninja-build pkg-config ccache
  liblcm-dev liblcm-bin libopencv-dev libceres-dev libeigen3-dev libyaml-cpp-dev libexpected-dev libspdlog-dev libfmt-dev libcli11-dev
  nlohmann-json3-dev libsqlite3-dev libpng-dev libjpeg-dev zlib1g-dev libbz2-dev liblz4-dev libzstd-dev
  libcairo2-dev libavformat-dev libswscale-dev libmicrohttpd-dev libgl-dev libegl-dev libegl1
  libgl1-mesa-dri colmap
  libgtest-dev libgmock-dev libbenchmark-dev iproute2 util-linux"
packaging="debhelper debootstrap dh-python dpkg-dev git help2man lintian python3 zsh"

# Drawing without a display: by OSMesa; where Mesa no longer has it (apt knows Mesa, but not it) by EGL.
if apt-cache show libosmesa6 >/dev/null 2>&1 || ! apt-cache show libegl1 >/dev/null 2>&1; then
  packages="$packages libosmesa6"
fi

check_only=false
if [ "${1:-}" = --check ]; then
  check_only=true
  shift
fi
if [ "${1:-}" = --packaging ]; then
  packages="$packages $packaging"
  shift
fi

if ! command -v dpkg-query >/dev/null; then
  echo "This is not a Debian system: install the equivalents of these packages yourself, then go on:" $packages "$@" >&2
  exit 0
fi

missing=""
for package in $packages "$@"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "Debian packages to install (apt-get, without recommended ones):$missing"
if $check_only; then
  exit 1
fi

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "error: this needs root and there is no sudo; as root run: apt-get install --no-install-recommends$missing" >&2
    exit 1
  fi
  echo "sudo is used for this, and may ask for your password."
  as_root=sudo
fi
$as_root apt-get update -q
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
