#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the wire types into a temporary prefix and builds another project's programs against them: by the CMake package,
# by pkg-config, in C++, in C and in Python. Builds and runs the examples as they are installed, too.
#   install_test.sh BUILD_DIR SOURCE_DIR
# Exit code 77 (CTest: skipped) where the examples could not be run: no Python, or no network of their own.
set -eu
build=$1
source=$2
consumer=$source/tests/rumi/install_consumer
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
prefix=$dir/prefix
examples=$prefix/share/doc/rumi/examples
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# A Python below the prefix, as Debian's is below /usr/local, is told of the package.
if command -v python3 >/dev/null; then
  python3 -m venv --without-pip "$prefix"
  PATH=$prefix/bin:$PATH
fi
cmake --install "$build" --prefix "$prefix" --component lcmtypes >/dev/null
[ ! -e "$prefix/share/rumi/lcmtypes/python" ] || fail "the component lcmtypes has Python in it"
cmake --install "$build" --prefix "$prefix" --component python >/dev/null
for file in include/lcmtypes/rumi/image_t.hpp include/lcmtypes/rumi_image_t.h share/rumi/lcmtypes/image.lcm \
  share/rumi/lcmtypes/c/rumi_image_t.c share/rumi/lcmtypes/python/rumi/image_t.py share/rumi/lcmtypes/python/rumi/lcm/bus.py \
  share/doc/rumi/LICENSE; do
  [ -s "$prefix/$file" ] || fail "not installed: $file"
done
[ ! -e "$prefix/bin/rumi" ] || fail "the programs are installed, too"

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

# What is not built is named with the target that builds it.
cmake -S "$source" -B "$dir/not_built" -G Ninja -DRUMI_TESTS=OFF >/dev/null
for component in programs lcmtypes python; do
  said=$(cmake --install "$dir/not_built" --prefix "$dir/nowhere" --component $component 2>&1) && fail "$component: installed before it is built"
  echo $said | grep -q "is not built yet. First: cmake --build $dir/not_built --target $component" || fail "$component: $said"
done

said=$(cmake --install "$dir/not_built" --prefix "$dir/nowhere" 2>&1) && fail "all of it is installed before it is built"
echo $said | grep -q "First: cmake --build $dir/not_built --target apps" || fail "all: $said"

cmake -S "$examples" -B "$dir/examples" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$dir/examples"
command -v python3 >/dev/null || {
  echo "SKIPPED: python3 is missing, so the examples were built, but NOT run" >&2
  exit 77
}
env -u PYTHONPATH "$prefix/bin/python3" -c 'import rumi; rumi.lcm.EventLog' || fail "a Python below the prefix does not find the package"
export PYTHONPATH="$prefix/share/rumi/lcmtypes/python"
"$source/tests/run_in_netns.sh" python3 "$source/tests/rumi/examples_test.py" "$dir/examples/listener" "$examples"
