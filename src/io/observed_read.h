#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/files/channel_reader.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// Receives the samples of all channels of a part while read_frame decodes it.
using BandObserver = std::function<void(const FrameSource& source, int file, int part,
                                        const std::vector<std::string>& channels, const Band& band)>;

/// As read_frame. The parts in use are decoded once, for the frame and for the observer.
ReadResult read_frame(const std::string& path, const ReadOptions& options, const BandObserver& observer);

}  // namespace polyrecon
