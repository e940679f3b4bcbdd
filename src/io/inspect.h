#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "polyrecon/read_frame.h"

namespace polyrecon {

/// Counts over all samples of a layer (its alpha excluded).
struct LayerStatistics {
  std::string layer;
  std::size_t pixels = 0;
  std::size_t nan = 0, infinite = 0, negative = 0;  ///< Pixels with such a sample in any channel.
  double minimum = 0, maximum = 0, mean = 0;        ///< Of the finite samples.
};

struct Inspection {
  FrameSource source;
  std::vector<LayerStatistics> statistics;  ///< By file and part; layers of unreadable parts are left out.
  std::vector<std::string> missing;         ///< Roles that no layer plays: "variance", "albedo", ...
  double samples = 0;                       ///< Samples per pixel where known, else 0.
  double noise_level = -1;  ///< Mean over pixels of variance / (mean^2 + 0.01) of the beauty; -1 where unknown.
  std::vector<std::string> notes;
};

/// Reads the whole file and tells what is in it. Throws like read_frame, except that a file without beauty is described
/// too.
Inspection inspect(const std::string& path, const ReadOptions& options = {});

}  // namespace polyrecon
