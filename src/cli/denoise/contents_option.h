#pragma once

#include <string>

namespace polyrecon {

/// The contents of a result.
struct ResultContents {
  bool layers = true;                 ///< Layers of the input that are not denoised.
  bool working = true;                ///< Variances, halves and sample counts of the input.
  bool noisy = false;                 ///< The layers that were replaced.
  bool error = false, order = false;  ///< The maps of these names, as layers.
};

constexpr const char* default_contents = "input";

/// The contents that a list such as "layers,error" names. Throws Error{Usage} where a word is unknown, or where none
/// says which layers of the input are kept.
ResultContents parse_contents(const std::string& list);

}  // namespace polyrecon
