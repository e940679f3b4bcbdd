// Checks which of the images that come with a pass can be trusted, whether they come from files or from memory.
#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"

namespace polyrecon {

/// The names of a pass's images in notes.
struct PassNames {
  std::string mean, variance, half_a, half_b;
};

/// Empties a variance without a finite value, and one of which more than half is not finite where the mean is. Returns
/// a note on it, and on single samples that are not finite; empty where there is nothing to say.
std::string check_variance(Image& variance, const Image& mean, const PassNames& names);

/// A note on the beauty's variance where the picture contradicts it: neighbouring pixels would differ by more than they
/// do. Empty otherwise. advice: what the user can do.
std::string note_on_large_variance(const Pass& beauty, const PassNames& names, const std::string& advice);

/// Empties halves that contradict the mean, since the result is made of the halves and would be another picture.
/// Returns a note on it; empty where they agree. advice: what the user can do, where all samples of the halves are
/// finite.
std::string check_halves(Pass& pass, const PassNames& names, const std::string& advice);

}  // namespace polyrecon
