#pragma once

#include "maps/error_map_images.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {

/// Calls visit(image) for all images of a Result, which may be const.
template <typename AnyResult, typename Visit>
void for_images(AnyResult& result, const Visit& visit) {
  for (auto* image : {&result.beauty, &result.alpha, &result.order}) visit(*image);
  for (auto& aov : result.aovs) visit(aov);
  for (const ErrorMapImage& entry : error_map_images) visit(result.error.*entry.image);
}

}  // namespace polyrecon
