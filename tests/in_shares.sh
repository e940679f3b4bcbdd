#!/usr/bin/env bash
# Runs a GoogleTest program in 16 shares, as many at a time as there are cores. A process for each test, as ctest has it,
# takes a minute longer, because the program loads 260 libraries.
#
#     tests/in_shares.sh PROGRAM [OPTION...]
set -euo pipefail
seq 0 15 | GTEST_TOTAL_SHARDS=16 xargs -P "$(nproc)" -I{} env GTEST_SHARD_INDEX={} "$@" --gtest_brief=1
