#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/layers.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// The rank of a prior that a driver puts next to the picture: results do not replace it.
constexpr int rank_of_made_prior = 9;

/// A pass by the name that a renderer gives it.
struct PassName {
  std::string name;  ///< As the renderer writes it; names are compared without case, blanks, '_', '-' and brackets.
  Role role;
  int rank;                  ///< Among layers of one role in one view layer the one of the lowest rank is used.
  std::size_t channels = 0;  ///< Channels of a layer with this name; 0: all that the role allows.
};

/// A word that names of features contain, without capitals.
struct FeatureWord {
  std::string word;
  Role role;
};

/// How the name of a layer that accompanies another one is made from the name of that one.
struct CompanionAffix {
  enum class Place {
    BehindPass,  ///< "albedo_var" accompanies "albedo".
    BeforeWord   ///< "m2_aov.albedo" accompanies "aov.albedo", and "aov.m2_path" accompanies "aov.path".
  };
  std::string text;
  Companion companion;
  Place place = Place::BehindPass;
};

/// A companion of the beauty that has a name of its own. Case matters.
struct BeautyCompanion {
  std::string name;
  Companion companion;
};

/// An attribute of the file that holds the samples per pixel.
struct SamplesAttribute {
  std::string name;          ///< "{}" stands for the view layer.
  bool of_sequence = false;  ///< The header of a render of samples 17 to 32 of 64 still says 64.
};

/// The form in which a renderer takes a sample map (--export).
struct SampleMapFormat {
  enum class Values {
    Importance,  ///< Samples over the largest number of samples, 0 to 1.
    Mask         ///< 1 for at least half a sample, else 0.
  };
  std::string option;                 ///< As typed after --export; empty if the renderer takes no map.
  std::vector<std::string> channels;  ///< All have the same values.
  Values values = Values::Importance;
  std::string usage;  ///< How to use the file; "{max}" stands for the largest number of samples.
};

/// The place where a user of a renderer switches a pass on.
struct PassSwitch {
  Role role;
  std::string place;  ///< "View Layer > Passes > Data > Denoising Data"
};

/// The names and quirks of one renderer. Each has a file in this folder; the list of all is in renderers.cpp.
struct Renderer {
  std::string name;
  std::string versions;  ///< Which versions or outputs the names belong to, for the documentation; may be empty.

  std::vector<PassName> passes;
  std::vector<PassName> letters;  ///< Letters of layers of one channel with a name that the user gives. Case matters.
  std::vector<FeatureWord> feature_words;  ///< For passes that no renderer is known to write; the first word decides.
  std::vector<std::string> data_prefixes;  ///< Passes whose names begin so hold data even if they look like colours.
  std::vector<CompanionAffix> affixes;
  std::vector<BeautyCompanion> beauty_companions;
  bool beauty_moment_is_nested = false;  ///< The beauty's second moment accompanies the nested integrator's picture.

  std::vector<std::string> denoised_suffixes;  ///< "<beauty>_denoised" is a prior.
  std::string noisy_suffix;                    ///< "<layer> Noisy" is what the layer was before it was denoised.
  std::string noisy_beauty;                    ///< Next to this pass the other beauties of a view layer are denoised.

  std::vector<SamplesAttribute> samples_attributes;
  std::string sample_fraction;  ///< Sample-count pass that holds a fraction of the metadata's number.
  std::string render_time;      ///< Pass with the cost of each pixel.

  /// Light passes that are divided by the colour of the surface, which another pass holds: sums of them are no beauty.
  std::vector<std::string> divided_passes;
  /// The passes with these colours, as far as they have no role: they are averages like light, but no light.
  std::vector<std::string> surface_colors;

  /// Pass with the depth of a pixel's first sample; averages of it are wrong at edges.
  std::string compositing_depth;
  /// The first sample of a pixel lies at its centre in every render, whatever the seed.
  bool first_sample_is_central = false;

  /// Least depth that the renderer writes where a ray hits nothing. Files do not say who wrote them: the least of all
  /// renderers decides for every file, and depths from a tenth of it on are sky (known_names.h).
  double sky_depth = std::numeric_limits<double>::infinity();
  /// Factors that turn the channels of the motion pass into Frame::motion.
  std::array<Real, 4> motion_factors{1, 1, 1, 1};
  SampleMapFormat sample_map;
  std::string
      many_layers;  ///< The name of the file type that holds passes, where another type holds the picture alone.
  std::vector<PassSwitch> switches;           ///< For features that improve the result.
  std::string noise_switch;                   ///< How its renders come to tell their noise; may be empty.
  std::vector<std::string> other_pass_files;  ///< Passes without a role that it writes to files of their own.
};

/// All renderers. Where two use one name for different roles or ranks, the first of them decides.
const std::vector<Renderer>& renderers();

}  // namespace polyrecon
