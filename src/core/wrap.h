#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// Columns by which a panorama is extended at both ends: more than a default window is wide at a quarter of the
/// resolution (84 pixels), and twice a block of centres (blend/blend_windows.h), so that blocks stay where they are.
constexpr int wrap_margin = 128;

/// The columns of an image with those of the other end beyond both ends. An empty image stays empty.
Image wrapped(const Image& image);

/// The columns of an image without those that wrapped() added.
Image unwrapped(const Image& image);

/// Wraps all images of a frame. The data window stays as it is; Frame::wraps becomes false.
void wrap(Frame& frame);

}  // namespace polyrecon
