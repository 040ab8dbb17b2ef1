# SPDX-License-Identifier: BSD-3-Clause
# Toolchain file: builds for arm64 on a Debian of another architecture (packages crossbuild-essential-arm64 and, with
# `dpkg --add-architecture arm64`, the libraries as :arm64), and runs the tests under qemu-user. See scripts/cross_arm64.sh.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)
