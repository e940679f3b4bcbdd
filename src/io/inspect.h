#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "polyrecon/read_frame.h"

namespace polyrecon {

/// Counts over all samples of a layer, without its alpha.
struct LayerStatistics {
  std::string layer;
  std::size_t pixels = 0;
  std::size_t nan = 0, infinite = 0, negative = 0;  ///< Pixels with such a sample in any channel.
  double minimum = 0, maximum = 0, mean = 0;        ///< Over the finite samples.
};

/// The contents of a file.
struct Inspection {
  FrameSource source;
  std::vector<LayerStatistics> statistics;  ///< By file and part; layers of unreadable parts are left out.
  std::vector<std::string> missing;  ///< Roles that the renderer has a name for, and companions, without a layer.
  double samples = 0;                ///< Samples per pixel; 0 if unknown.
  double noise_level = -1;           ///< Mean over pixels of variance / (mean^2 + 0.01) of the beauty; -1 if unknown.
  std::vector<std::string> notes;
  std::optional<Frame> frame;  ///< As read_frame reads it; none in a file without beauty.

  /// nullptr for a layer of an unreadable part.
  const LayerStatistics* statistics_of(const std::string& layer) const;
};

/// Reads the whole file, decoding each part once, and describes it. Throws as read_frame, except that a file without
/// beauty is described too.
Inspection inspect(const std::string& path, const ReadOptions& options = {});

}  // namespace polyrecon
