#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// The part of a pass inside r. Images that the pass lacks stay empty.
Pass crop(const Pass& pass, const Rect& r);

/// The part of a frame inside r, which is given in pixels of the frame's images.
Frame crop(const Frame& frame, const Rect& r);

}  // namespace polyrecon
