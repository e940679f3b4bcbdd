#!/usr/bin/env bash
# Installs missing packages, builds, checks formats, and runs all tests. Ends with the summary of ctest and whether the
# tests with Open Image Denoise ran. tests/analyze.sh looks for faults that need a build or minutes of their own.
set -euo pipefail
cd "$(dirname "$0")/.."

# Prints the name of a part and how long the run has taken before it.
part() { echo "== $1 (after $SECONDS s)"; }

part packages
samples/install_dependencies.sh --tests
tests/pipelines/make_venv.sh

part clang-format
find include src tests -name '*.cpp' -o -name '*.h' | xargs clang-format --dry-run -Werror

part ruff
build/venv/bin/ruff check
build/venv/bin/ruff format --check

part "build, warnings are errors"
cmake --preset check
cmake --build --preset check

# The tests of --prior oidn, with the library of the wheel that make_venv.sh installs.
oidn=$(find "$PWD"/build/venv/lib -path '*/pyoidn/oidn/lib/libOpenImageDenoise.so.2' -print -quit)
export POLYRECON_OIDN=$oidn

part "unit tests"
for program in unit_tests command_line_tests program_tests library_tests; do
  tests/in_shares.sh "build/check/tests/$program"
done

part "all other tests"
ctest --preset check -LE '^unit$'
part end
echo "Open Image Denoise: ${oidn:-not installed, the tests of --prior oidn were skipped}"
