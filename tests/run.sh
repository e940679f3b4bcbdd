#!/usr/bin/env bash
# Installs missing packages, builds, checks format and style, and runs all tests. Ends with the summary of ctest and
# whether the tests with Open Image Denoise ran.
set -euo pipefail
cd "$(dirname "$0")/.."

# Runs a GoogleTest program in 16 shares. A process for each test, as ctest has it, takes a minute longer, because the
# program loads 260 libraries.
in_shares() {
  seq 0 15 | GTEST_TOTAL_SHARDS=16 xargs -P "$(nproc)" -I{} env GTEST_SHARD_INDEX={} "$1" --gtest_brief=1
}

echo "== packages"
samples/install_dependencies.sh --tests
tests/pipelines/make_venv.sh

echo "== clang-format"
find include src tests -name '*.cpp' -o -name '*.h' | xargs clang-format --dry-run -Werror

echo "== ruff"
build/venv/bin/ruff check
build/venv/bin/ruff format --check

echo "== build, warnings are errors"
cmake --preset dev
cmake --build --preset dev

echo "== clang-tidy"
run-clang-tidy -p build/dev -quiet -j "$(nproc)" "^$PWD/src/" >build/dev/clang-tidy.log 2>&1 || {
  grep -E -A3 '(error|warning):' build/dev/clang-tidy.log
  exit 1
}

echo "== unit tests under AddressSanitizer and UndefinedBehaviorSanitizer"
cmake --preset asan
cmake --build --preset asan --target unit_tests
in_shares build/asan/tests/unit_tests

# The tests of --prior oidn, with the library of the wheel that make_venv.sh installs. Not above: a library that is loaded
# later is built without the sanitizers.
oidn=$(find "$PWD"/build/venv/lib -path '*/pyoidn/oidn/lib/libOpenImageDenoise.so.2' -print -quit)
export POLYRECON_OIDN=$oidn

echo "== unit tests"
for program in unit_tests command_line_tests program_tests library_tests; do
  in_shares "build/dev/tests/$program"
done

echo "== all other tests"
ctest --preset dev -LE '^unit$'
echo "Open Image Denoise: ${oidn:-not installed, the tests of --prior oidn were skipped}"
