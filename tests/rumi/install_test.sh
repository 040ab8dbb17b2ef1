#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the wire types into a temporary prefix and builds another project's programs against them: by the CMake package,
# by pkg-config, in C++ and in C.
#   install_test.sh BUILD_DIR CONSUMER_DIR
set -eu
build=$1
consumer=$2
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
prefix=$dir/prefix

cmake --install "$build" --prefix "$prefix" --component lcmtypes >/dev/null
for file in include/lcmtypes/rumi/image_t.hpp include/lcmtypes/rumi_image_t.h share/rumi/lcmtypes/image.lcm \
  share/rumi/lcmtypes/c/rumi_image_t.c share/rumi/lcmtypes/python/rumi/image_t.py; do
  [ -s "$prefix/$file" ] || { echo "not installed: $file" >&2; exit 1; }
done

cmake -S "$consumer" -B "$dir/cmake" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$dir/cmake"
"$dir/cmake/consumer_cpp"
"$dir/cmake/consumer_c"

pc_dir=$(dirname "$(find "$prefix" -name rumi-lcmtypes.pc)")
flags=$(PKG_CONFIG_PATH=$pc_dir pkg-config --cflags --libs rumi-lcmtypes)
c++ -o "$dir/by_pkg_config_cpp" "$consumer/consumer.cpp" $flags
cc -o "$dir/by_pkg_config_c" "$consumer/consumer.c" $flags
"$dir/by_pkg_config_cpp"
"$dir/by_pkg_config_c"
echo "installed wire types serve C and C++, by CMake and by pkg-config"
