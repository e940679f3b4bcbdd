#pragma once

#include "features/prepare.h"
#include "noise/variance.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// The noise of a frame and the decisions about it, made before its pixels are worked on.
struct Survey {
  NoiseVariance noise;      ///< That of the beauty.
  Preparation preparation;  ///< The features that take part, and which steps run.
};

/// Determines the noise of a frame and decides which of the steps run. Features of unknown noise get a variance in
/// `frame` if the prefilter may run, and void pixels and lamps are hidden (hide_void). Throws Error{CheckFailed} where
/// the beauty has no usable pixel, Error{Interrupted} when progress asks to stop.
Survey survey_frame(Frame& frame, const Steps& steps, Progress& progress);

}  // namespace polyrecon
