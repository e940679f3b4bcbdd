#pragma once

#include <OpenEXR/ImfHeader.h>

#include <array>
#include <string>
#include <vector>

#include "io/merge/task.h"
#include "io/renderers/polyrecon.h"

namespace polyrecon {

/// The layers that are written for a merged layer, by what follows its name: mean, variance, halves.
inline constexpr std::array output_companions{"", variance_suffix, half_a_suffix, half_b_suffix};

/// The name of a channel in the output, which has one part.
std::string output_name(const Render& first, const Layer& layer, const std::string& channel,
                        const std::string& companion = {});

/// The name of the channel of a view layer's sample counts.
std::string count_name(const std::string& view_layer);

/// The header of the result: windows, channels, and the metadata of the first render with the samples of all.
/// Appends a note where the compression is not the requested one.
Imf::Header output_header(const MergeTask& task, const Encoding& encoding, std::vector<std::string>& notes);

}  // namespace polyrecon
