#pragma once

#include <OpenEXR/ImfHeader.h>

#include <functional>
#include <string>

#include "io/exr/bands.h"

namespace polyrecon {

/// Writes a new file of one part; make fills each band of so many lines (a multiple of 32), once. What was written is
/// remembered and compared when it is read back (BandCheck). See write_atomically.
void write_single_part(const std::string& target, const Imf::Header& header,
                       const std::function<void(NativeBand&)>& make, int lines = band_lines);

}  // namespace polyrecon
