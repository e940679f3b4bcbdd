#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// The area in which one render may have samples, and the layer that shows where it has.
struct ShownPart {
  Rect window;                        ///< The data windows of all its parts together.
  const FileInfo* file = nullptr;     ///< File of the beauty.
  int part = 0;                       ///< Part of the beauty.
  std::vector<std::string> channels;  ///< Channels of the beauty, with its alpha.
};

/// The pixels that one render has samples for.
struct Region {
  Rect rect;
  std::size_t group = 0;  ///< Index of the first render that shows the same region of the frame.
  std::size_t rank = 0;   ///< Place among the renders of its group.
};

/// Finds which pixels each render has samples for.
///
/// A data window may be a region of the frame: beyond it the render has no samples. Or the renderer has cut black
/// margins away: beyond the window the render saw black, which counts. A render can also keep the window of the frame
/// and be black outside its region; the box of its pixels that are not black then takes the place of its window.
///
/// Renders whose boxes have at least half of the smaller one in common form a group. Each of them has samples over the
/// union of the group, except beyond a side of its box at which the picture goes on: there, half of the pixels of the
/// other renders are not black, or 16 pixels of each render on average.
std::vector<Region> find_regions(const std::vector<ShownPart>& renders);

/// The share of the pixels covered by any rectangle that one alone covers.
double share_of_single_cover(const std::vector<Rect>& rects);

}  // namespace polyrecon
