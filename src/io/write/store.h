#pragma once

#include <cstddef>

#include "io/exr/bands.h"

namespace polyrecon {

/// Stores a value as the channel's type. Counts half values that were out of range and are saturated.
void store(NativeChannel& channel, std::size_t i, float value, std::size_t& saturated);

}  // namespace polyrecon
