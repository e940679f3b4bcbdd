#!/usr/bin/env bash
# Builds against a newer OpenEXR than the system's and runs the unit tests with it. OpenEXR's source comes from PyPI; needs pip
# and the network. Linked statically and hidden: the system's OpenImageIO brings its own OpenEXR into the same process, and the
# C functions of the two (exr_*) have the same names.
#   tests/newer_openexr.sh [VERSION]
set -euo pipefail
cd "$(dirname "$0")/.."
version=${1:-3.5.3}
build=$PWD/build/newer_openexr
export CMAKE_BUILD_PARALLEL_LEVEL=$(nproc)

mkdir -p "$build"
[ -e "$build/openexr-$version.tar.gz" ] ||
  build/venv/bin/pip download --quiet --no-deps --no-binary OpenEXR --dest "$build" "OpenEXR==$version"
tar -C "$build" -xf "$build/openexr-$version.tar.gz"
cmake -S "$build/openexr-$version" -B "$build/openexr" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_TESTING=OFF -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_BUILD_EXAMPLES=OFF \
  -DOPENEXR_BUILD_PYTHON=OFF -DCMAKE_INSTALL_PREFIX="$build/installed" --log-level=WARNING
cmake --build "$build/openexr"
cmake --install "$build/openexr" >/dev/null
cmake --preset dev -B "$build/polyrecon" -DCMAKE_PREFIX_PATH="$build/installed" -DPOLYRECON_BENCHMARKS=OFF \
  -DCMAKE_EXE_LINKER_FLAGS=-Wl,--exclude-libs,ALL
cmake --build "$build/polyrecon" --target polyrecon --target unit_tests
cmake -LA -N "$build/polyrecon" | grep '^OpenEXR_DIR'
"$build/polyrecon/tests/unit_tests" --gtest_brief=1
