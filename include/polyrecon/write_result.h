// Writes results: a copy of the input file with layers replaced, and files of maps.
#pragma once

#include <string>
#include <utility>
#include <vector>

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

/// Contents in addition to the replaced layers.
struct WriteOptions {
  bool keep_noisy = false;  ///< Keep the replaced samples as the layer `<Layer> Noisy`.
  Provenance provenance;
};

/// Writes a copy of the file source.path in which layers are replaced. Parts, layers, names, types, windows, metadata
/// and compression stay the same. Parts without a replacement are copied chunk by chunk; channels that are not replaced
/// keep their bits. A part with a lossy compression is written with ZIP, as encoding it again would change the other
/// channels. Half values beyond 65504 saturate. Returns notes on the last two, one line each.
///
/// The file takes its name only after it was read back and found equal, so target may be the input itself. Throws
/// Error{CannotWrite}, and Error{BadInput} if a part that is copied turns out to be damaged; an older target then stays
/// as it was.
std::vector<std::string> write_result(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options = {});

/// A channel of a map file.
struct MapChannel {
  std::string name;  ///< "samples.Y"
  Image image;       ///< 1 channel.
};

/// Attributes of a map file by name. Numbers are written as float.
struct MapAttributes {
  std::vector<std::pair<std::string, std::string>> strings;
  std::vector<std::pair<std::string, double>> numbers;
};

/// Writes a file of maps with one part, float samples, and ZIP. All images have the size of the data window. The file
/// takes its name only after it was read back. Throws Error{CannotWrite}; an older target then stays as it was.
void write_maps(const std::string& target, const std::vector<MapChannel>& channels, const Rect& data_window,
                const Rect& display_window, const MapAttributes& attributes = {});

}  // namespace polyrecon
