#pragma once

#include "io/pictures/color.h"

namespace polyrecon {

/// values (1 channel) -> display-encoded RGB on the perceptually uniform colour map "inferno" (S. van der Walt and
/// N. Smith, 2015), on a logarithmic scale over range. What is not above its lower end is black, what is not finite
/// cyan.
Image false_color(const Image& values, const LogRange& range);

/// Values 0 to 1 (1 channel) -> display-encoded RGB on the colour map "magma", linear: how FLIP is shown.
Image flip_color(const Image& values);

}  // namespace polyrecon
