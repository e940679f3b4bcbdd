#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/denoise/frame_files.h"
#include "polyrecon/read_frame.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// One of the pictures of a file.
struct PictureChoice {
  LayerView place;
  std::string layer;  ///< A layer that gets windows of its own; empty: the beauty.

  /// "view layer ViewLayer, view left, layer Shadow Catcher"; empty for a file with one picture.
  std::string name() const;
};

/// The paths of the maps of a picture that is not the first of its file: error.exr becomes error.ViewLayer.right.exr.
/// Picture and report are those of the file.
OutputPaths maps_of(OutputPaths outputs, const PictureChoice& picture);

/// The options that read this picture.
ReadOptions with_picture(ReadOptions options, const PictureChoice& picture);

/// A frame before or after, prepared for reconstruct; several frames in work may share it.
struct LoadedNeighbour {
  int offset = 0;
  std::shared_ptr<const Neighbour> frame;  ///< Empty where the file could not be read.
  std::string identity;                    ///< Identity of the bytes that it was read from, or that could not be read.
};

/// A picture in memory, with the frames that help it.
struct LoadedFrame {
  ReadResult in;
  double read_seconds = 0;
  std::vector<LoadedNeighbour> neighbours;
  PictureChoice picture;
  std::string identity;  ///< Identity of all files that `in` was read from; see io/files/file_identity.h.

  /// The suffix of the identity for the neighbours.
  std::string neighbours_identity() const;
};

/// The suffix for a neighbour in time behind the identity of a frame.
std::string neighbour_text(int offset, const std::string& identity);

/// Throws Error{BadInput} where a file changes while it is read, and as read_frame does.
LoadedFrame load_frame(const std::string& path, const ReadOptions& options);

}  // namespace polyrecon
