#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/pictures/color.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// One picture of a preview.
struct Panel {
  Image rgb;                 ///< 3 channels, display-encoded, 0..1.
  std::string caption;       ///< One line; cut where it is wider than the panel.
  LogRange range = {};       ///< Range of a false-colour picture, for its legend. {0, 0}: none.
  std::string figures = {};  ///< One line below the caption, cut like it.
};

/// A preview of more pixels is refused.
constexpr std::size_t most_pixels_of_preview = std::size_t{1} << 28;

/// The panels side by side on a dark ground, each with its caption (and legend) in a strip below; a single panel
/// without caption and legend is the bare picture. Where no font is found the strips stay without text. Throws
/// Error{OutOfMemory} where the picture would have more than most_pixels_of_preview.
Image compose(const std::vector<Panel>& panels);

/// The rows one below the other, from the left, on the same dark ground. Throws like compose.
Image stack(const std::vector<Image>& rows);

/// Whether this machine has a font to write captions with.
bool has_font();

/// The bytes of rgb (3 channels, 0..1) with 8 bits a channel. format: OpenImageIO's name, "png", "jpeg" or "tiff".
std::string encode_picture(const Image& rgb, const std::string& format);

}  // namespace polyrecon
