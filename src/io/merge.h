#pragma once

#include <string>
#include <vector>

#include "io/exr_file.h"

namespace polyrecon {

struct MergeOptions {
  std::string view_layer;  ///< Empty: all of them.
  ReadLimits limits;
};

struct MergeResult {
  int files = 0;
  double samples = 0;               ///< Mean samples per pixel of the result; 0 where no file tells.
  std::vector<std::string> merged;  ///< Layers with mean, variance and halves.
  std::vector<std::string> kept;    ///< Layers taken from the first file.
  std::vector<std::string> notes;
};

/// Joins K independent renders of one frame (subsets of one sequence, or different seeds): per pixel and channel of each
/// noisy layer the mean weighted by sample counts, ` Variance` (of that mean) and the means ` A`, ` B` of the renders with even
/// and odd index; the rest from the first file. Reads one file at a time. Writes one part, as write_result does.
/// Throws Error{Usage} for fewer than two files, Error{BadInput} naming the first file that does not fit the first.
MergeResult merge(const std::vector<std::string>& paths, const std::string& target, const MergeOptions& options = {});

}  // namespace polyrecon
