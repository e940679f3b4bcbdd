#pragma once

#include <array>
#include <cstddef>

#include "core/rect.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// One way to reconstruct the frame. The two halves are fitted separately: each is made from data that the other half,
/// which validates it, does not share.
struct Candidate {
  std::array<Image, 2> half;  ///< Channels as in HalfPair::color.
  Image squared_bias;         ///< As the windows estimate it (5), 3 channels; empty if the candidate has none.
  Image variance;             ///< Variance (6) of the windows, 3 channels; empty if the candidate has none.
  Image order;                ///< Taylor order, 1 channel.
};

/// A candidate of zeros with all its images.
Candidate make_candidate(int width, int height, int color_channels);

/// The part of a candidate inside r.
Candidate crop(const Candidate& candidate, const Rect& r);

/// Copies the part `from` of source to the place (x, y) of target.
void paste(const Candidate& source, const Rect& from, Candidate& target, int x, int y);

/// Channels of a candidate with all its images.
std::size_t candidate_channels(std::size_t color_channels);

}  // namespace polyrecon
