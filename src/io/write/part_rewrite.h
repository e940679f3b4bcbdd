// The parts of a file that is written again: their headers, and where the samples of their channels come from.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <map>
#include <string>
#include <vector>

#include "core/rect.h"
#include "polyrecon/layers.h"
#include "polyrecon/write_result.h"

namespace polyrecon {

/// The source of a channel's new samples: a plane of an image, or the mean of all its planes.
struct NewChannel {
  const Image* image = nullptr;
  Rect window;  ///< Place of the image.
  int plane = 0;
  bool mean = false;
  std::string noisy_name;  ///< Channel for the old samples; empty where they are not kept.

  float at(std::size_t i) const {
    if (!mean) return static_cast<float>(image->plane(plane)[i]);
    double sum = 0;
    for (int c = 0; c < image->channels(); ++c) sum += image->plane(c)[i];
    return static_cast<float>(sum / image->channels());
  }
};

using NewChannels = std::map<std::string, NewChannel>;  ///< The key is the whole name of the channel.

/// How one part is written.
struct PartRewrite {
  int input;  ///< Its index in the input.
  Imf::Header header;
  NewChannels replaced;     ///< New samples, of channels of the input or of others.
  bool copied_raw = false;  ///< Chunk by chunk.
};

/// The layer of the input with this name. Throws Error{Missing}.
const Layer& layer_named(const FrameSource& source, const std::string& name);

/// The name of a channel of the layer that stands next to `layer`: with the suffix " Noisy", "ViewLayer.Combined.R"
/// becomes "ViewLayer.Combined Noisy.R", and "Combined.right.R" "Combined Noisy.right.R". A channel without a layer
/// gets the layer's pass in front.
std::string name_beside(const Layer& layer, const std::string& channel, const std::string& suffix,
                        const std::string& last_word);

/// The channels of the layer that the replacement stands for: its colour, or its alpha.
std::vector<std::string> channels_to_replace(const Layer& layer, const Replacement& replacement);

/// How every part of the file `input` is written. Puts a note into `notes` for each that is not packed as requested, or
/// not as in the input.
std::vector<PartRewrite> plan_parts(const FrameSource& source, const std::vector<Imf::Header>& input,
                                    const std::vector<Replacement>& replacements, const WriteOptions& options,
                                    std::vector<std::string>& notes);

/// Whether the samples of a part can be decoded and encoded again: a flat image of one level, with all its samples.
bool is_plain(const Imf::Header& header);

/// Names a part in messages: part 2 "right".
std::string part_title(const Imf::Header& header, int part);

}  // namespace polyrecon
