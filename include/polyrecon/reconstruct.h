// Reconstructs a frame: the main call of the library.
#pragma once

#include <memory>
#include <vector>

#include "polyrecon/denoiser.h"
#include "polyrecon/error_map.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"
#include "polyrecon/timed_neighbour.h"

namespace polyrecon {

/// The reconstruction of a frame. All images have the width and height of the frame.
struct Result {
  Image beauty;             ///< yhat of equation (3): 3 channels, linear radiance.
  std::vector<Image> aovs;  ///< In the order of Frame::aovs, 3 channels each.
  Image alpha;              ///< 1 channel; empty if the frame has none.
  ErrorMap error;           ///< Estimated error of beauty.
  Image order;              ///< 1 channel: mean of the orders k, equation (7), of the windows that cover a pixel.
  Report report;            ///< The work, counted and measured.
};

/// Reconstructs one frame by the method of Moon et al. 2016. To save memory it takes features, halves and variances out
/// of the frame and frees them as soon as possible; means, names, alpha and sample count stay. A frame that needs more
/// than params.max_memory is worked in tiles, with the same result to the bit. Throws Error{Usage} if a parameter is
/// out of its range, Error{CheckFailed} if the beauty has no usable pixel or the result would change its energy by more
/// than half, Error{OutOfMemory} if not even the smallest tile fits, and Error{Interrupted} when progress asks to stop.
Result reconstruct(Frame& frame, const Params& params, Progress& progress);

/// The same with the help of frames before and after, which are averaged into the frame along its motion vectors. The
/// neighbours have any order and are at most params.temporal.radius frames away. They count towards params.max_memory.
/// denoiser: if given, it makes the prior of what the neighbours have joined, in place of the frame's.
Result reconstruct(Frame& frame, const std::vector<TimedNeighbour>& neighbours, const Params& params,
                   Progress& progress, const Denoiser* denoiser = nullptr);

/// Prepares a frame for the reconstruction of its neighbours in time, once for all of them. number: the frame's number.
/// Frames that are used together need different numbers: a frame without half buffers is split into halves with random
/// numbers that depend on it. Throws as reconstruct does.
std::shared_ptr<const Neighbour> prepare_neighbour(Frame frame, int number, const Params& params, Progress& progress);

}  // namespace polyrecon
