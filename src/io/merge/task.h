#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/rect.h"
#include "io/merge/render.h"
#include "polyrecon/merge.h"

namespace polyrecon {

/// A channel that is merged: the index of its layer, and its index in all_channels.
struct Slot {
  std::size_t layer, channel;
};

/// The plan of a merge, decided before the pictures are read.
struct MergeTask {
  std::vector<Render> renders;
  double samples = 0;        ///< Samples of each render; 0: as the files say.
  Rect window;               ///< Window of the result: all regions.
  bool has_regions = false;  ///< Some renders have samples of a part of the frame only.
  bool joins = false;        ///< Too much of the picture has one render only: no variance or halves are made.
  std::vector<std::size_t> merged, kept;           ///< Indices of layers.
  std::vector<Slot> slots;                         ///< The channels of all merged layers.
  std::vector<std::string> counted;                ///< View layers whose sample counts are known.
  std::map<std::string, double> metadata_samples;  ///< By view layer, of all renders of the first one's group.
  std::vector<bool> half_b;                        ///< For each render whether it is of half B.
  bool halves_weigh_alike = false;                 ///< The halves were given.
  std::string shared_samples;  ///< The note on samples that the renders have in common; empty without one.

  const Render& first() const { return renders.front(); }
};

/// Decides how the renders are merged, and reports it. first_b: index of the first render of half B; those before it
/// are half A. 0: as split_renders divides them. Throws as merge.
MergeTask make_task(std::vector<Render> renders, const MergeOptions& options, std::size_t first_b, MergeResult& report);

}  // namespace polyrecon
