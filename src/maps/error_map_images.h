#pragma once

#include <array>
#include <cstddef>

#include "polyrecon/error_map.h"

namespace polyrecon {

/// One of the images of an ErrorMap, and its channels in the file that --error-map writes.
struct ErrorMapImage {
  Image ErrorMap::*image;
  std::array<const char*, 3> names;  ///< Names of the channels; nullptr beyond the last.
  bool may_be_missing = false;       ///< In the file: earlier versions did not write it, or there is no such thing.

  constexpr std::size_t channels() const {
    std::size_t count = 0;
    while (count < names.size() && names[count] != nullptr) ++count;
    return count;
  }
};

inline constexpr std::array<ErrorMapImage, 5> error_map_images{{{&ErrorMap::mse, {"mse.R", "mse.G", "mse.B"}},
                                                                {&ErrorMap::relative_mse, {"relmse.Y"}},
                                                                {&ErrorMap::relative_variance, {"relvariance.Y"}},
                                                                {&ErrorMap::relative_noise, {"relnoise.Y"}, true},
                                                                {&ErrorMap::prior_share, {"priorshare.Y"}, true}}};

static_assert(sizeof(ErrorMap) == error_map_images.size() * sizeof(Image) + sizeof(double),
              "an image of ErrorMap has no row in error_map_images");

/// Channels of an ErrorMap with all its images, or all but the share of a prior.
constexpr std::size_t error_map_channels(bool with_prior) {
  std::size_t count = 0;
  for (const ErrorMapImage& image : error_map_images)
    if (with_prior || image.image != &ErrorMap::prior_share) count += image.channels();
  return count;
}

}  // namespace polyrecon
