#!/usr/bin/env bash
# Runs the program on a small frame under valgrind's memcheck: every quality but best, one thread and two, maps, halves from
# the file and split by the program, further layers, merging, comparing. Any error or lost memory ends it with 1; nothing is
# suppressed. "Possibly lost" is not counted: oneTBB's threads still hold their stacks at the end. Some ten minutes.
#   tests/valgrind.sh [POLYRECON]
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-build/release/src/polyrecon}
sample=samples/study_small_
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

check() {
  echo "polyrecon $*" >&2
  valgrind --quiet --error-exitcode=1 --leak-check=full --show-leak-kinds=definite,indirect \
    --errors-for-leak-kinds=definite,indirect --num-callers=30 "$program" "$@"
}
check inspect "${sample}0.exr" >/dev/null
check merge "$sample"[0-3].exr -o "$folder/merged.exr" --quiet
check denoise -i "$folder/merged.exr" -o "$folder/standard.exr" --threads 2 --quiet --error-map "$folder/error.exr" \
  --sample-map "$folder/samples.exr" --budget 8
check denoise -i "${sample}0.exr" -o "$folder/draft.exr" --quality draft --threads 1 --quiet
check compare "${sample}0.exr" "$folder/draft.exr" "$folder/standard.exr"
echo "no error"
