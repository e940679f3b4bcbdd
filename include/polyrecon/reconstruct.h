#pragma once

#include <memory>
#include <vector>

#include "polyrecon/error_map.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// What comes out of a frame; all images have the frame's width and height.
struct Result {
  Image beauty;             ///< 3 channels, linear radiance.
  std::vector<Image> aovs;  ///< In the order of Frame::aovs, 3 channels each.
  Image alpha;              ///< 1 channel; empty where the frame has none.
  ErrorMap error;           ///< How wrong each pixel of beauty may still be.
  Image order;              ///< 1 channel: the order k of equation (7) as blended from the windows that cover a pixel.
  Report report;
};

/// The whole method on one frame: reads like the abstract of Moon et al. 2016. Takes the frame's features, halves and
/// variances and releases them as it goes; means, names, alpha and sample count stay with the caller. Frames that need
/// more memory than params.max_memory are worked in tiles, with the same result to the bit. Throws Error{BadInput}
/// where the frame holds nothing to work on (no finite beauty pixel), Error{OutOfMemory} where not even the smallest
/// tile fits, Error{Interrupted} when progress asks to stop.
Result reconstruct(Frame& frame, const Params& params, Progress& progress);

/// A frame as the frames before and after it need it (temporal/neighbour.h).
struct Neighbour;

/// A neighbour and its place in time: `offset` frames after the frame in hand (before it where negative).
struct TimedNeighbour {
  int offset = 0;
  const Neighbour* frame = nullptr;  ///< Must outlive the call.
};

/// The same with the help of frames before and after (temporal/join.h), as prepare_neighbour made them, sorted in any
/// way, at most params.temporal.radius frames away. They count towards params.max_memory.
Result reconstruct(Frame& frame, const std::vector<TimedNeighbour>& neighbours, const Params& params,
                   Progress& progress);

/// A frame as its neighbours in time need it, which is the same for all of them. number: of the frame; two frames that
/// meet must not have the same one, since noise of a frame without half buffers is split with random numbers of its
/// own. Throws as reconstruct does.
std::shared_ptr<const Neighbour> prepare_neighbour(const Frame& frame, int number, const Params& params,
                                                   Progress& progress);

}  // namespace polyrecon
