#pragma once

#include <array>

#include "polyrecon/image.h"
#include "temporal/geometry.h"

namespace polyrecon {

/// The relative squared change of radiance to expect from the change between the surfaces of two frames, 1 channel: of
/// the albedo, as if the light stayed the same, and of the normal, as if the light came from the side. Another depth is
/// another surface. Surfaces that one frame lacks are left out; the change is 0 where both lack all.
/// a: surfaces of the current frame (Geometry::surface), of the given size.
/// noise: surface_noise of a.
/// b: the same surfaces in other frames, at the places of the pixels of a.
Image surface_change(int width, int height, const std::array<Image, surfaces>& a,
                     const std::array<Image, surfaces>& noise, const std::array<Image, surfaces>& b);

}  // namespace polyrecon
