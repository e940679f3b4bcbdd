#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// The mask (core/mask.h) of the pixels in which a spike may be a firefly: all but those of the sky's own spikes, such
/// as stars. There no sample hit a surface, so the normal is 0, and the albedo is 0, or has the same spike as it holds
/// the sky. A volume before the sky has an albedo, but no normal, and scatters fireflies; an albedo that has a spike
/// where there is a surface is no sign of a star: glass lets the same samples make both. Empty without such pixels, or
/// where the frame lacks a normal or an albedo.
Image firefly_mask(const Frame& frame);

}  // namespace polyrecon
