#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// Columns that a panorama is extended by at both ends. Twice the radius of the usual windows at a quarter of the
/// resolution is less, and blocks of centres (blend/blend_windows.h) stay where they are.
constexpr int wrap_margin = 128;

/// The columns of an image with those of the other end beyond both ends. An empty image stays empty.
Image wrapped(const Image& image);

/// The columns of an image without those that wrapped() added.
Image unwrapped(const Image& image);

/// Wraps all images of a frame. The data window stays as it is; Frame::wraps becomes false.
void wrap(Frame& frame);

}  // namespace polyrecon
