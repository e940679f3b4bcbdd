#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/renderers/renderers.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// The class of a pass by the renderers' names.
struct PassClass {
  Role role = Role::Other;
  int rank = 0;
  std::string renderers;     ///< The names of those that use this name.
  std::size_t channels = 0;  ///< As PassName::channels.
};

/// pass: a name without its view layer. Nothing where no renderer is known to use it.
std::optional<PassClass> classify_pass(const std::string& pass);

/// The same for the only channel of a layer, by its letter.
std::optional<PassClass> classify_letter(const std::string& letter);

/// The feature that a pass seems to be by the words in its name, "my_normals", where no renderer is known to use it.
std::optional<Role> feature_in_words(const std::string& pass);

/// Whether a renderer that gives its beauty this name has a name for the role. True if no renderer is known to.
bool can_have(const std::string& beauty, Role role);

/// Whether a and b are one name: they are compared without case, blanks, '_', '-' and brackets.
bool same_name(std::string_view a, std::string_view b);

/// Whether the name begins as those of passes that hold data.
bool has_data_prefix(const std::string& pass);

/// Whether the other beauties of a view layer with this pass are denoised.
bool is_noisy_beauty(const std::string& pass);

/// Whether a sample-count pass holds a fraction of the number in the metadata.
bool is_sample_fraction(const std::string& pass);

/// Whether the pass holds what each pixel cost.
bool is_render_time(const std::string& pass);

/// Whether the pass is light divided by the colour of the surface.
bool is_divided(const std::string& pass);

/// Whether the pass is the colour of surfaces without being a feature.
bool is_surface_color(const std::string& pass);

/// An attribute's name with the view layer in place of "{}".
std::string with_view_layer(std::string attribute, const std::string& view_layer);

/// Whether an attribute's name is this one, whose "{}" stands for the view layer. Without a name of the view layer, as
/// in files of one layer, for any.
bool names_attribute(const std::string& attribute, const std::string& name, const std::string& view_layer);

/// The attributes that can hold the samples per pixel of a view layer, in the order in which they are looked for.
std::vector<SamplesAttribute> samples_attributes(const std::string& view_layer);

/// The least depth that a renderer writes where a ray hits nothing. Larger depths say no more.
double sky_value();

/// Depths from here on are sky: a tenth of sky_value, as a pixel at the edge of the sky averages it with smaller
/// depths.
double sky_depth();

/// Whether the pass holds the depth of each pixel's first sample, for compositing. Averages of it are wrong at edges.
bool is_compositing_depth(const std::string& pass);

/// The attributes with the samples per pixel which show that the first one lies at the pixel's centre.
std::vector<std::string> attributes_of_central_samples(const std::string& view_layer);

/// Factors that turn the channels of a motion pass into Frame::motion. A pass that no renderer is known to use is taken
/// for one of the first renderer that has motion.
std::array<Real, 4> motion_factors(const std::string& pass);

/// Whether a renderer writes a pass of this name, which has no role, to a file of its own.
bool is_other_pass_file(const std::string& word);

/// Whether a renderer writes the name in just this spelling.
bool is_written_so(const std::string& pass);

/// Whether the name is that of a companion of the beauty: "variance".
bool is_beauty_companion(const std::string& pass);

/// Endings behind the names of beauties that a denoiser has left: "_denoised".
std::vector<std::string> denoised_endings();

/// Endings behind the name of a pass in that of a companion: "Variance".
std::vector<std::string> companion_endings();

}  // namespace polyrecon
