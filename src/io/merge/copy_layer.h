#pragma once

#include <cstddef>

#include "io/exr/bands.h"
#include "io/merge/task.h"

namespace polyrecon {

/// Copies the channels of a layer with their bits, whatever their type, from the first render that shows a pixel.
/// Throws Error{BadInput} where a render has another type.
void copy_layer(const MergeTask& task, std::size_t layer, NativeBand& band);

}  // namespace polyrecon
