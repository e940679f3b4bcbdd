#pragma once

#include "core/candidate.h"
#include "core/half_pair.h"
#include "polyrecon/frame.h"

namespace polyrecon {

/// The mask (core/mask.h) of the pixels of a frame that are not void. Empty where all are, or none is.
///
/// A pixel is void where nothing was rendered: beauty, colour layers and alpha are 0, and so are the features (a depth
/// may be that of the sky, a visibility 1). Examples are the surroundings of a render region, transparent film, and the
/// gaps between the islands of a light map. A value that is not finite counts as 0 where alpha is 0. Without an alpha
/// or a feature, no pixel is void: black is then a colour.
///
/// If void pixels and others are mixed like salt and pepper, as in a thin volume, the void ones are samples that
/// found nothing, and they do not count as void.
Image rendered_mask(const Frame& frame);

/// The mask of the pixels that count as samples: the rendered ones and the void ones around soft borders, where alpha
/// is between 0 and 1. There the scene ends by itself, so the void next to it is a sample like any other. At a hard
/// border, such as that of a render region, the scene was cut off, and the void says nothing of it. Without alpha,
/// borders count as soft. rendered: of the frame, by rendered_mask.
Image sampled_mask(const Image& rendered, const Frame& frame);

/// Sets all samples outside of a mask to NaN, except alpha and the prior, so that statistics leave them out.
void hide_void(const Image& rendered, Frame& frame);

/// Sets void pixels of a pair and of a result to 0.
void empty_void(const Image& rendered, HalfPair& pair, Candidate& result);

}  // namespace polyrecon
