#!/usr/bin/env bash
# Runs the program under ThreadSanitizer with an instrumented oneTBB, without which the sanitizer cannot see that a loop has
# ended. Any race ends it with 1; nothing is suppressed. Needs clang-16 and a folder with oneTBB's source, as
# `apt-get source onetbb` unpacks it. Some minutes.
#   tests/thread_sanitizer.sh ONETBB_SOURCE
set -euo pipefail
cd "$(dirname "$0")/.."
source=${1:?"the folder of oneTBB's source"}
tbb=$PWD/build/tsan_tbb
clang=(-DCMAKE_C_COMPILER=clang-16 -DCMAKE_CXX_COMPILER=clang++-16)

cmake -S "$source" -B "$tbb" -G Ninja "${clang[@]}" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread \
  -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBB4PY_BUILD=OFF -DCMAKE_INSTALL_PREFIX="$tbb/installed" --log-level=WARNING
cmake --build "$tbb"
cmake --install "$tbb" >/dev/null
cmake --preset tsan "${clang[@]}" -DTBB_DIR="$tbb/installed/lib/cmake/TBB"
cmake --build --preset tsan --target polyrecon

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TSAN_OPTIONS=halt_on_error=1
program=build/tsan/src/polyrecon
sample=samples/study_small_
check() {
  echo "polyrecon $*" >&2
  "$program" "$@"
}
check inspect "${sample}0.exr" >/dev/null
check merge "$sample"[0-3].exr -o "$folder/merged.exr" --quiet
check denoise -i "$folder/merged.exr" -o "$folder/standard.exr" --threads 4 --quiet --error-map "$folder/error.exr" \
  --sample-map "$folder/samples.exr" --budget 8
check denoise -i "${sample}0.exr" -o "$folder/draft.exr" --quality draft --threads 4 --quiet
check denoise -i samples/study_denoised_16.exr -o "$folder/prior.exr" --quality draft --threads 4 --quiet
check compare "${sample}0.exr" "$folder/draft.exr" "$folder/standard.exr"
echo "no race"
