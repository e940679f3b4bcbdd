#pragma once

#include <optional>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/layers.h"

namespace polyrecon {

constexpr int last_rank = 1000;      ///< The rank of a layer that has no known name.
constexpr int rank_by_hand = -1000;  ///< The rank of a layer that the user named.

inline bool is_half(Companion c) { return c == Companion::HalfA || c == Companion::HalfB; }

/// Whether the variance of the mean can be made of what such a companion holds.
inline bool is_variance(Companion c) { return c != Companion::Mean && !is_half(c); }

/// Groups the channels of all parts into layers, in file order, and classifies them.
std::vector<Layer> find_layers(const FileInfo& file);

/// Sets role, companion and rank of layers by the names that renderers use (io/renderers/).
void classify_layers(const std::vector<FileInfo>& files, std::vector<Layer>& layers);

/// If a file without a beauty has a single colour layer, makes it the beauty. Returns whether it did.
bool adopt_only_color(std::vector<Layer>& layers);

/// The layer that holds the picture: the first view layer and view with a beauty, in it the denoised beauty where there
/// is one and the noisy one otherwise; nullptr where the file has neither.
const Layer* picture_layer(const std::vector<Layer>& layers);

/// A companion and the layer that it accompanies, by its name: "m2_img" is the second moment of "img".
struct NamedCompanion {
  Companion companion = Companion::Mean;
  std::string mean;
};

/// The kind of variance that a layer is by its name alone, and the layer that it accompanies. Nothing where the name
/// says none.
std::optional<NamedCompanion> variance_by_name(const Layer& layer);

/// Whether the layer is a picture whose channels are CIE XYZ.
bool is_picture_in_xyz(const Layer& layer);

/// Whether a lossy compression may change a layer: colours only. Ids, vectors and distances lose their meaning, and
/// noise would no longer be that of the picture.
bool may_lose_precision(const Layer& layer);

/// Whether all channels of the layer are unsigned integers: identifiers, not values.
bool all_uint(const std::vector<FileInfo>& files, const Layer& layer);

/// Whether denoise wrote the file.
bool is_result(const FileInfo& file);

/// Samples per pixel of a view layer by the metadata, nothing where they do not hold it.
std::optional<double> samples_in_metadata(const FileInfo& file, const std::string& view_layer);

}  // namespace polyrecon
