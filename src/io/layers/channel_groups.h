#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/layers.h"

namespace polyrecon {

bool ends_with(std::string_view text, std::string_view end);

/// The last word of a channel's name: "R" of "ViewLayer.Combined.R"; all of a name without a dot.
std::string_view after_last_dot(std::string_view name);

constexpr const char* bare_pass = "RGBA";        ///< The pass of colour channels without a prefix: R, G, B, A.
constexpr const char* bare_tristimulus = "XYZ";  ///< The pass of bare X, Y, Z in a part without a bare colour.
constexpr const char* bare_luminance = "Y";      ///< The pass of a bare Y in a part without a bare colour.

/// Whether a pass is one of these, the whole of a file that holds one image.
inline bool is_bare_name(const std::string& pass) {
  return pass == bare_pass || pass == bare_tristimulus || pass == bare_luminance;
}

/// Groups the channels of all parts into layers, in file order. Sets names, views and channels; roles are not set.
///
/// The name of a layer is the prefix of its channels: "diffuse.R" and "diffuse.red" belong to "diffuse". Channels
/// without a dot that end in the letters of a colour or a vector are a layer too: "AlbedoR", "AlbedoG", "AlbedoB" are
/// "Albedo", "albedo:R", "albedo:G", "albedo:B" are "albedo". In files with several named parts, channels without a
/// prefix belong to a layer with the name of the part (OpenEXR's convention), except those next to a bare colour or to
/// channels with a prefix, and those of a part whose name only counts ("subimage03"). In other files R, G, B, A without
/// a prefix are one layer, and every other channel is a layer.
///
/// Features among the channels of a colour, the Z of "right.R", "right.G", "right.B", "right.Z", are layers of their
/// own.
///
/// A view is the last or the first word of a name, or at either end of a part's name. A file that does not list its
/// views has "left" and "right" where several names contain one of them.
std::vector<Layer> group_channels(const FileInfo& file);

/// The name of a channel within its layer: "R" of "diffuse.R" and of "AlbedoR".
std::string word_of(const Layer& layer, const std::string& channel);

/// Whether the channels are those of a colour: R, G, B in any spelling.
bool is_rgb(const Layer& layer);

/// Whether the channels of a colour have no prefix.
bool is_bare(const Layer& layer);

}  // namespace polyrecon
