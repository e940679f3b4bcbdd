#!/usr/bin/env bash
# Makes the wheel for other machines, build/packages/polyrecon-*.whl: with a current OpenEXR, OpenImageIO and OpenColorIO
# (libraries.sh), and with all libraries inside that are not on every Linux. Words are passed to pip, for example
# --config-settings=cmake.define.POLYRECON_SIMD_CLONES=OFF.
#     src/package/wheel/wheel.sh [WORD ...]
set -euo pipefail
cd "$(dirname "$0")/../../.."
libraries=$PWD/build/wheel/libraries
src/package/wheel/libraries.sh "$libraries"
rm -rf build/wheel/unrepaired
mkdir -p build/packages
# Not isolated: the build tools are those of libraries.sh.
PATH=$libraries/tools/bin:$PATH "$libraries/tools/bin/python3" -m pip wheel --no-deps \
  --no-build-isolation --disable-pip-version-check --wheel-dir build/wheel/unrepaired --config-settings=build-dir=build/wheel_program \
  --config-settings=cmake.define.POLYRECON_WHEEL_LIBRARIES="$libraries" "$@" .
rm -f build/packages/polyrecon-*.whl
LD_LIBRARY_PATH=$libraries/lib PATH=$libraries/tools/bin:$PATH "$libraries/tools/bin/auditwheel" repair \
  --wheel-dir build/packages build/wheel/unrepaired/polyrecon-*.whl
ls -l build/packages/polyrecon-*.whl
