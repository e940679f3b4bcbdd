#!/usr/bin/env bash
# Installs missing packages, builds, checks format and style, and runs all tests. Ends with the summary of ctest and
# whether the tests with Open Image Denoise ran.
set -euo pipefail
cd "$(dirname "$0")/.."

# Runs a GoogleTest program in 16 shares, with the options that follow. A process for each test, as ctest has it, takes a
# minute longer, because the program loads 260 libraries.
in_shares() {
  seq 0 15 | GTEST_TOTAL_SHARDS=16 xargs -P "$(nproc)" -I{} env GTEST_SHARD_INDEX={} "$@" --gtest_brief=1
}

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

part clang-tidy
cmake --preset tidy
# Files of io/ and core/ in the module are those of the library once more.
sources="^$PWD/(src|build/tidy/src)/(?!CMakeFiles/polyrecon_pictures\.dir/Unity/unity_folder_(io|core))"
run-clang-tidy -p build/tidy -quiet -j "$(nproc)" "$sources" >build/tidy/clang-tidy.log 2>&1 || {
  grep -E -A3 '(error|warning):' build/tidy/clang-tidy.log
  exit 1
}

part "unit tests under AddressSanitizer and UndefinedBehaviorSanitizer"
cmake --preset asan
cmake --build --preset asan --target unit_tests
# These take half of the time of all unit tests: accuracy, memory, and many runs whose bits are compared. Other tests run
# the same code, and the sanitizers would find the same in it.
statistics=Void.ResultsDoNotDependOnTiles:StatedMemory.OfAReconstructionIsWhatItAllocates
statistics+=:Steps.ASimpleSceneTakesLessWorkThanAllSteps:FitAndBlend.ACropAlignedToTwoBlocksHasTheSameBitsInside
statistics+=:Case27.*:Panorama.TheResultTurnsWithTheFrame:Pilot.SeesAPartOfTheFrameAndTheWholeOfItsError
statistics+=:Reconstruct.TakesTheNoiseOutOfASceneOfKnownTruth
in_shares build/asan/tests/unit_tests "--gtest_filter=-$statistics"

# The tests of --prior oidn, with the library of the wheel that make_venv.sh installs. Not above: a library that is loaded
# later is built without the sanitizers.
oidn=$(find "$PWD"/build/venv/lib -path '*/pyoidn/oidn/lib/libOpenImageDenoise.so.2' -print -quit)
export POLYRECON_OIDN=$oidn

part "unit tests"
for program in unit_tests command_line_tests program_tests library_tests; do
  in_shares "build/check/tests/$program"
done

part "all other tests"
ctest --preset check -LE '^unit$'
part end
echo "Open Image Denoise: ${oidn:-not installed, the tests of --prior oidn were skipped}"
