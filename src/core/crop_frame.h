#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// The part of a pass inside r. Images that the pass lacks stay empty.
Pass crop(const Pass& pass, const Rect& r);

/// The part of a frame inside r, in pixels of the frame's images. A part of a panorama does not wrap.
Frame crop(const Frame& frame, const Rect& r);

}  // namespace polyrecon
