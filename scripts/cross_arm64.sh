#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds for arm64 on another architecture and runs the unit tests under qemu-user. Installs packages of both
# architectures, as root: meant for a chroot, which scripts/on_debian.sh makes:
#   RUMI_CHROOTS=/var/tmp/rumi-cross scripts/on_debian.sh bookworm scripts/cross_arm64.sh [BUILD]
# BUILD: default build-arm64. Left out are tests that start our programs, which the kernel here cannot run, and tests that
# draw: qemu-user does not get on with the code that Mesa's llvmpipe makes while it runs.
set -eu
build=${1:-build-arm64}
native="crossbuild-essential-arm64 cmake ninja-build pkg-config ccache python3 qemu-user
  libeigen3-dev libcli11-dev nlohmann-json3-dev"
libraries="liblcm-dev libopencv-dev libceres-dev libyaml-cpp-dev libexpected-dev libspdlog-dev libfmt-dev libsqlite3-dev libpng-dev
  libjpeg-dev zlib1g-dev libbz2-dev liblz4-dev libzstd-dev libcairo2-dev libavformat-dev libswscale-dev libmicrohttpd-dev libgl-dev
  libegl-dev libosmesa6 libgtest-dev libgmock-dev"
dpkg --add-architecture arm64
apt-get update -q
DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $native $(printf '%s:arm64 ' $libraries)
# Debian's LCM is of one architecture at a time.
mkdir -p "$build"
printf '#!/bin/sh\nexec qemu-aarch64 /usr/bin/lcm-gen "$@"\n' >"$build/lcm-gen"
chmod +x "$build/lcm-gen"
cmake -S . -B "$build" -G Ninja -DCMAKE_TOOLCHAIN_FILE=cmake/arm64.cmake -DLCM_GEN="$PWD/$build/lcm-gen"
cmake --build "$build" -j "$(nproc)"
ctest --test-dir "$build" -j "$(nproc)" --output-on-failure --timeout 3000 \
  -R '^(slam|base|bus|camera_driver|map_server|map_builder|rumi_tool|rumi_supervisor|rumi_garbage|rumi_calibration|fuzz)_test$'
