#!/usr/bin/env bash
# Looks for faults that tests do not show: clang-tidy on all sources, then the unit tests under AddressSanitizer and
# UndefinedBehaviorSanitizer. Needs what tests/run.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset tidy
# Files of io/ and core/ in the module are those of the library once more.
sources="^$PWD/(src|build/tidy/src)/(?!CMakeFiles/polyrecon_pictures\.dir/Unity/unity_folder_(io|core))"
run-clang-tidy -p build/tidy -quiet -j "$(nproc)" "$sources" >build/tidy/clang-tidy.log 2>&1 || {
  grep -E -A3 '(error|warning):' build/tidy/clang-tidy.log
  exit 1
}
echo "clang-tidy: nothing found (after $SECONDS s)"

# Without Open Image Denoise: a library that is loaded later is built without the sanitizers.
cmake --preset asan
cmake --build --preset asan --target unit_tests
env -u POLYRECON_OIDN tests/in_shares.sh build/asan/tests/unit_tests
echo "sanitizers: nothing found (after $SECONDS s)"
