// Writes results: a copy of the input file with layers replaced, and files of maps.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "polyrecon/encoding.h"
#include "polyrecon/frame.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// New samples of a layer.
struct Replacement {
  std::string layer;   ///< Layer::name.
  Image image;         ///< A channel for each of the layer's, or 3 for a layer of 1: the mean.
  bool alpha = false;  ///< Replace the layer's alpha instead of its colour; 1 channel.
  Rect window = {};    ///< Place of the image (Frame::data_window); empty: the data window of the layer's part. Pixels
                       ///< of the part that the image does not cover keep their samples.
};

/// How a file was made. Written as the attributes polyrecon/version, polyrecon/settings, polyrecon/input and
/// polyrecon/estimatedRelMSE.
struct Provenance {
  std::string settings;                ///< The settings that the result depends on.
  std::string input;                   ///< Identity of the input, such as its name and size.
  double estimated_relative_mse = -1;  ///< Negative: unknown, not written.
};

/// A layer that stands next to the picture that it describes, such as its error.
struct Addition {
  std::string layer;   ///< Layer::name of the picture.
  std::string suffix;  ///< " Error": of "ViewLayer.Combined" it makes the channel "ViewLayer.Combined Error.X".
  Image image;         ///< 1 channel, stored as 32-bit float.
  Rect window = {};    ///< As that of a Replacement; other pixels of the part are 0.
};

/// Contents next to the replaced layers, and how they are packed.
struct WriteOptions {
  bool keep_noisy = false;  ///< Keep the replaced samples as the layer `<Layer> Noisy`.
  Provenance provenance;
  bool keep_layers = true;   ///< Keep the layers that are not replaced: features, light passes, data.
  bool keep_working = true;  ///< Keep variances, halves and sample counts of the input.
  std::vector<Addition> additions = {};
  Encoding encoding = {};  ///< Without a compression: that of each part, ZIP where it may change samples.
};

/// Writes a copy of the file source.path in which layers are replaced. Parts, layers, names, types, windows, metadata
/// and compression stay the same, unless the options say otherwise. Parts that do not change are copied chunk by chunk;
/// channels that are not replaced keep their bits, unless a compression that the options name may change them. Only
/// colours may be changed by a compression: a part is written with ZIP where other channels would be, too. Deep parts,
/// mipmaps and subsampled channels keep their compression. Half values beyond 65504 saturate. Returns notes on all of
/// this, one line each.
///
/// The file takes its name only after it was read back and found equal, so target may be the input itself. Throws
/// Error{CannotWrite}, and Error{BadInput} if a part that is copied turns out to be damaged; an older target then stays
/// as it was.
std::vector<std::string> write_result(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options = {});

/// A channel of a map file.
struct MapChannel {
  std::string name;      ///< "samples.Y"
  Image image;           ///< 1 channel.
  bool is_half = false;  ///< Stored as half float.
};

/// Attributes of a map file by name. Numbers are written as float.
struct MapAttributes {
  std::vector<std::pair<std::string, std::string>> strings;
  std::vector<std::pair<std::string, double>> numbers;
};

/// Writes a file of maps with one part; ZIP if the encoding names no compression. All images have the size of the data
/// window. The file takes its name only after it was read back. Throws Error{CannotWrite}; an older target then stays
/// as it was.
void write_maps(const std::string& target, const std::vector<MapChannel>& channels, const Rect& data_window,
                const Rect& display_window, const MapAttributes& attributes = {}, const Encoding& encoding = {});

}  // namespace polyrecon
