#pragma once

#include <string>
#include <utility>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// New samples for one layer: one image channel for each of its channels. A layer with one channel takes the mean of
/// three.
struct Replacement {
  std::string layer;   ///< Layer::name.
  Image image;         ///< Width and height of Frame::data_window.
  bool alpha = false;  ///< Replace the layer's alpha instead of its colour (FrameSource::alpha_layer); 1 channel.
};

/// What the file says about how it was made: written as polyrecon/version, polyrecon/settings, polyrecon/input and
/// polyrecon/estimatedRelMSE.
struct Provenance {
  std::string settings;
  std::string input;                   ///< Identity of the input, e.g. its name and size.
  double estimated_relative_mse = -1;  ///< Negative: unknown, not written.
};

struct WriteOptions {
  bool keep_noisy = false;  ///< Keep what is replaced under `<Layer> Noisy`.
  Provenance provenance;
};

/// Writes the file source.path anew with the given layers replaced: same parts, layers, names, types, windows, metadata
/// and compression. Parts without a replacement are copied chunk by chunk, other channels keep their bits; a part with
/// a lossy compression is written with ZIP, since encoding it again would change the other channels. Half values beyond
/// 65504 saturate. Returns notes on both. The file takes its name only after it was read back and found equal: target
/// may be the input itself; try it with check_writable before computing. Throws Error{CannotWrite}, an older target is
/// then untouched. Throws Error{BadInput} where a part that is only copied turns out to be damaged.
std::vector<std::string> write_result(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options = {});

/// One channel of a map file.
struct MapChannel {
  std::string name;  ///< "samples.Y"
  Image image;       ///< 1 channel.
};

/// Attributes of a map file; numbers as text become string attributes, doubles become float ones.
struct MapAttributes {
  std::vector<std::pair<std::string, std::string>> strings;
  std::vector<std::pair<std::string, double>> numbers;
};

/// Writes error, order and sample maps: one part, float, ZIP. Same promises as write_result.
void write_maps(const std::string& target, const std::vector<MapChannel>& channels, const Rect& data_window,
                const Rect& display_window, const MapAttributes& attributes = {});

}  // namespace polyrecon
