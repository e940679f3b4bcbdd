#pragma once

#include "cli/common/option_set.h"
#include "io/files/file.h"

namespace polyrecon {

/// Adds --max-pixels and --max-channels: larger files are refused before their pixels are read.
void add_read_limits(OptionSet& set, ReadLimits& limits);

}  // namespace polyrecon
