#!/usr/bin/env bash
# Fuzzes the EXR reader under AddressSanitizer and UndefinedBehaviorSanitizer for at least SECONDS (default 7200) and
# FILES (default 100000), then for a tenth of SECONDS the command line. A file fails if it takes more than 10 s of
# processor time, 10 minutes of wall-clock time or 2 GB of memory. Failing files are kept in build/fuzz/findings, the
# corpus in build/fuzz/corpus. Needs Debian's clang-16, which includes libFuzzer.
#   tests/fuzz/run.sh [SECONDS [FILES]]
# With CMAKE_PREFIX_PATH (and LD_LIBRARY_PATH) naming an OpenEXR built with the same flags, the fuzzer covers that library
# too; docs/dev/files_from_strangers.md says how to build it.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-7200} files=${2:-100000}

cmake --preset fuzz
cmake --build --preset fuzz
build=build/fuzz/tests/fuzz
mkdir -p build/fuzz/corpus build/fuzz/findings
"$build/make_seeds" samples build/fuzz/seeds

# allocator_may_return_null: an allocation that is far too large throws std::bad_alloc, as it does without a sanitizer.
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
fuzz() {
  "$build/exr_fuzzer" -dict=tests/fuzz/exr.dict -timeout=600 -report_slow_units=600 -rss_limit_mb=2048 \
    -max_len=16384 -print_final_stats=1 -artifact_prefix=build/fuzz/findings/ "$@" build/fuzz/corpus build/fuzz/seeds tests/fuzz/corpus 2>&1 |
    tee -a build/fuzz/log
}
: >build/fuzz/log
fuzz -max_total_time="$seconds"
done_files=$(awk '/stat::number_of_executed_units/ { n += $2 } END { print n + 0 }' build/fuzz/log)
[ "$done_files" -ge "$files" ] || fuzz -runs=$((files - done_files))
awk '/stat::number_of_executed_units/ { n += $2 } END { print n " files, findings:" }' build/fuzz/log
mkdir -p build/fuzz/words
"$build/options_fuzzer" -max_len=1000 -timeout=600 -artifact_prefix=build/fuzz/findings/ -max_total_time="$((seconds / 10))" build/fuzz/words
ls build/fuzz/findings
[ -z "$(ls build/fuzz/findings)" ]
