#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/exr/file.h"

namespace polyrecon {

/// What a layer is to the method. Color: a further colour pass that could be reconstructed (--aov); Other: data that is
/// only passed through (identifiers, positions, masks).
enum class Role { Beauty, Prior, Alpha, Albedo, Normal, Depth, Visibility, SampleCount, Motion, Color, Other };

/// What the samples of a layer tell about the pass: its mean, or something that accompanies the mean.
enum class Companion { Mean, VarianceOfMean, VarianceOfSample, SecondMoment, HalfA, HalfB };

/// Channels that belong together, with their meaning.
struct Layer {
  std::string name;        ///< What a user types: "ViewLayer.Combined"; unique in the file.
  std::string view_layer;  ///< "ViewLayer"; empty where names have no such prefix.
  std::string view;        ///< Stereo view, empty without one.
  std::string pass;        ///< "Combined"
  int file = 0;            ///< Index into FrameSource::files.
  int part = 0;
  std::vector<std::string> channels;  ///< Whole names, in the order R G B / X Y Z / as in the file; without alpha.
  std::string alpha;                  ///< Whole name of the layer's alpha channel, empty without one.
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string of;   ///< For companions: name of the layer that holds the mean.
  std::string why;  ///< One phrase: how role and companion were found.
  int rank = 0;     ///< Among layers of one role in one view layer the lowest rank is used.
};

constexpr int rank_by_hand = -1000;  ///< Of a layer that the user named.
constexpr int rank_beside = 9;  ///< Of a prior made to stand beside the picture: nobody looks for the result in it.

const char* name_of(Role role);
const char* name_of(Companion companion);
/// "beauty", "albedo", ... as typed in --map; nothing for an unknown word.
std::optional<Role> role_from(const std::string& name);

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
