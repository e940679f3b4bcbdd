#!/usr/bin/env bash
# Installs what is missing, builds, checks format and style, and runs every test; the last lines are ctest's own.
set -euo pipefail
cd "$(dirname "$0")/.."

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
seq 0 15 | GTEST_TOTAL_SHARDS=16 xargs -P "$(nproc)" -I{} env GTEST_SHARD_INDEX={} build/asan/tests/unit_tests --gtest_brief=1

echo "== all tests"
ctest --preset dev
