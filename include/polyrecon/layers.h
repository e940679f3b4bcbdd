#pragma once

#include <optional>
#include <string>
#include <vector>

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

const char* name_of(Role role);

const char* name_of(Companion companion);

/// "beauty", "albedo", ... as typed in --map; nothing for an unknown word.
std::optional<Role> role_from(const std::string& name);

}  // namespace polyrecon
