#pragma once

#include <optional>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/layers.h"

namespace polyrecon {

constexpr int rank_by_hand = -1000;  ///< Of a layer that the user named.
constexpr int rank_beside = 9;  ///< Of a prior made to stand beside the picture: nobody looks for the result in it.

/// What the table of names says of one pass.
struct PassClass {
  Role role = Role::Other;
  int rank = 0;
  std::string who;  ///< The renderers that use the name.
};

/// By the name alone, without its view layer; nothing where no renderer is known to use it.
std::optional<PassClass> classify_pass(const std::string& pass);

/// Groups the channels of all parts into layers and tells what each is, by the names that the renderers use (the table
/// is in channel_names.cpp). Layers come in file order.
std::vector<Layer> find_layers(const FileInfo& file);

/// The second half of find_layers: tells roles and companions of layers that are grouped (and perhaps renamed) already.
void classify_layers(const std::vector<FileInfo>& files, std::vector<Layer>& layers);

/// Whether a sample-count layer holds the fraction of the metadata's samples (Blender) instead of a number.
bool is_sample_fraction(const Layer& layer);

/// Samples per pixel of a view layer as the metadata tell, nothing where they do not.
std::optional<double> samples_in_metadata(const FileInfo& file, const std::string& view_layer);

}  // namespace polyrecon
