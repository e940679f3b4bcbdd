#pragma once

#include <CLI/CLI.hpp>

#include "io/exr/file.h"

namespace polyrecon {

/// --max-pixels and --max-channels: what a file may claim before it is refused.
void add_read_limits(CLI::App& app, ReadLimits& limits);

}  // namespace polyrecon
