#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test; the last lines are ctest's own.
set -euo pipefail
cd "$(dirname "$0")/.."
samples/install_dependencies.sh --tests
cmake --preset dev
cmake --build --preset dev
ctest --preset dev
