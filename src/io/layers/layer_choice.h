#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"

namespace polyrecon {

/// The layers of one pass that is read, as indices into FrameSource::layers; -1 without one.
struct PassChoice {
  Role role = Role::Other;
  int mean = -1, variance = -1, half_a = -1, half_b = -1;
};

/// The layers that are read of a file.
struct LayerChoice {
  FrameSource source;
  std::vector<PassChoice> passes;           ///< In the order of the roles, beauty first; the AOVs follow.
  std::vector<std::string> outside_beauty;  ///< As ReadResult::outside_beauty.
  std::vector<std::string> notes;
};

/// The choice of a mean with the variance and the halves that the file has of it.
PassChoice with_companions(const FrameSource& source, Role role, int mean);

/// Leaves out one half without the other, with a note if the user named it.
void require_both_halves(LayerChoice& choice, PassChoice& pass);

/// Drops the layers of a pass that cannot be laid over the beauty.
void drop_misfits(LayerChoice& choice, PassChoice& pass);

}  // namespace polyrecon
