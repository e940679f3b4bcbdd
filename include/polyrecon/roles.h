// The roles that layers play, and their properties.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>

namespace polyrecon {

/// The use of a layer in the method. The order is that of features in a Frame and of every list that people read.
/// Color: a further colour pass that can be reconstructed (--aov). Other: data that is only passed through.
enum class Role {
  Beauty,
  Normal,
  Albedo,
  Depth,
  Visibility,
  SpecularAlbedo,
  Roughness,
  Prior,
  SampleCount,
  Motion,
  Alpha,
  Color,
  Other,
};

constexpr std::size_t role_count = static_cast<std::size_t>(Role::Other) + 1;

constexpr std::size_t index_of(Role role) { return static_cast<std::size_t>(role); }

/// The kind of a layer's values. Renders of one frame are merged accordingly.
enum class Values {
  Radiance,  ///< Linear colour; averaged.
  Average,   ///< Another mean over the samples of a pixel; averaged.
  Count,     ///< Numbers of samples; added up.
  Exact      ///< Vectors, positions, identifiers; a mix of two values has no meaning.
};

/// How a feature enters the fit.
enum class FeatureTransform {
  Scaled,       ///< Times a factor that brings its values to order 1.
  BoundedDepth  ///< z / (z + median of z): bounded, so that distances of the sky fit too.
};

/// The value of a layer in pixels where nothing was rendered, or where rays hit nothing.
enum class EmptyValue {
  Zero,
  ZeroOrOne,  ///< Nothing occludes anything: a 1 does not show whether anything was rendered.
  ZeroOrSky   ///< Distances of the sky: Frame::sky_depth or more, 1e10 or +Inf.
};

/// The property of a surface that a pass holds. Renderers commonly write a pass for each.
enum class Surface {
  Color,
  Direction,  ///< Like Distance, it differs from an empty background, so that it shows silhouettes.
  Distance,
  None
};

/// Numbers of channels that a layer of a role can have.
class ChannelCounts {
 public:
  constexpr ChannelCounts(std::initializer_list<unsigned> counts) {  // NOLINT(google-explicit-constructor)
    for (const unsigned count : counts) bits_ |= 1U << count;
  }
  static constexpr ChannelCounts any() { return {}; }

  constexpr bool allow(std::size_t count) const { return bits_ == 0 || (count < 32 && (bits_ >> count & 1U) != 0); }

 private:
  constexpr ChannelCounts() = default;
  unsigned bits_ = 0;  ///< Bit n is set where n channels are allowed; 0: any number.
};

/// The properties of a role.
struct RoleInfo {
  Role role;
  const char* name;              ///< As typed in --map and --steps and printed by `inspect`.
  int channels;                  ///< In a Frame.
  ChannelCounts layer_channels;  ///< In a file.
  Values values;
  bool chosen = true;               ///< One layer of a view layer is chosen for it, by name or by --map.
  bool expected = false;            ///< `inspect` lists it as missing where no layer has the role.
  bool on_request = false;          ///< Read only where ReadOptions ask for it.
  bool in_fit = false;              ///< Its values are reconstructed or take part in the fit.
  bool feature = false;             ///< f of equation (2): its channels are columns of the local model.
  bool noise_is_estimated = false;  ///< A feature whose noise is estimated where the file does not hold it.
  FeatureTransform transform = FeatureTransform::Scaled;
  EmptyValue empty = EmptyValue::Zero;
  Surface surface = Surface::None;
};

/// A row for each role, in the order of the enumeration.
const std::array<RoleInfo, role_count>& role_table();

inline const RoleInfo& info_of(Role role) { return role_table()[index_of(role)]; }
inline const char* name_of(Role role) { return info_of(role).name; }
/// The role of a name as typed in --map; nothing for an unknown one.
std::optional<Role> role_from(const std::string& name);

/// Whether the noise of a pass is estimated from its mean. known: the file holds its variance or half buffers.
inline bool noise_is_estimated(Role role, bool known) { return !known && info_of(role).noise_is_estimated; }

/// A set of roles.
class RoleSet {
 public:
  bool has(Role role) const { return roles_[index_of(role)]; }
  void insert(Role role) { roles_.set(index_of(role)); }
  void erase(Role role) { roles_.reset(index_of(role)); }
  void clear() { roles_.reset(); }

 private:
  std::bitset<role_count> roles_;
};

/// All roles that are features.
RoleSet feature_roles();

}  // namespace polyrecon
