#pragma once

#include <string>

namespace polyrecon {

/// The files of one frame that `denoise` reads and writes; a path is empty where it was not asked for.
struct FrameFiles {
  std::string input, output, error_map, order_map, sample_map, report;
};

}  // namespace polyrecon
