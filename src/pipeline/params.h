#pragma once

#include <cstddef>

namespace polyrecon {

enum class Quality { Draft, Standard, Best };

/// Everything that steers a reconstruction; the only home of its defaults.
struct Params {
  Quality quality = Quality::Standard;
  int stages = 2;                      ///< Rounds of error estimation, equations (8) and (9); 1..4.
  int max_order = 2;                   ///< Highest Taylor order offered to the selection, 0..4.
  bool reconstruct_alpha = false;      ///< Reconstruct alpha with the beauty's windows instead of keeping it.
  std::size_t max_memory = std::size_t{4} << 30;  ///< Bytes; larger frames are worked in tiles.
};

/// Throws Error{Usage} naming the first value out of its range.
void validate(const Params& params);

}  // namespace polyrecon
