#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "html/viewer_page.h"

namespace polyrecon {

/// One image of a page in one or more of its frames.
struct ViewedFile {
  std::string path;
  std::size_t image = 0;            ///< Index of ViewerPage.
  std::vector<std::size_t> frames;  ///< Indices.
};

/// The part of the files that goes into the page.
struct ViewSelection {
  std::vector<std::string> layers;  ///< Names; empty: the picture or the main map of a file, then all others.
  bool first_only = false;          ///< Only the layer of each file that is shown first.
  std::optional<Rect> region;       ///< In the files' coordinates.
  int scale = 1;                    ///< The mean of scale x scale pixels becomes one pixel.
  std::size_t max_bytes = 0;        ///< Limit of the page.
};

/// Adds the layers of the files to the page: first what is shown first, then maps and variances, then all others, as
/// far as max_bytes allow. Returns notes about what was left out. Throws Error{Missing} where a file has no layer, or
/// none of the named ones, Error{Usage} where what is shown first does not fit, or where nothing of a file lies in the
/// region.
std::vector<std::string> add_files(ViewerPage& page, const std::vector<ViewedFile>& files,
                                   const ViewSelection& selection);

}  // namespace polyrecon
