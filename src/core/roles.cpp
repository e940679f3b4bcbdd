#include "polyrecon/roles.h"

#include <algorithm>

namespace polyrecon {
namespace {

enum class Noise { Estimated, IfKnown };

constexpr RoleInfo feature(Role role, const char* name, int channels, ChannelCounts layer_channels, Noise noise,
                           EmptyValue empty = EmptyValue::Zero, FeatureTransform transform = FeatureTransform::Scaled) {
  RoleInfo info{role, name, channels, layer_channels, Values::Average};
  info.expected = info.in_fit = info.feature = true;
  info.noise_is_estimated = noise == Noise::Estimated;
  info.empty = empty;
  info.transform = transform;
  return info;
}

constexpr RoleInfo showing(Surface surface, RoleInfo info) {
  info.surface = surface;
  return info;
}

/// A pass that describes the scene and takes no part in the fit.
constexpr RoleInfo description(Role role, const char* name, int channels, ChannelCounts layer_channels) {
  RoleInfo info{role, name, channels, layer_channels, Values::Average};
  info.chosen = false;
  return info;
}

constexpr RoleInfo color(Role role, const char* name, bool chosen, bool expected) {
  RoleInfo info{role, name, 3, {1, 3}, Values::Radiance, chosen, expected};
  info.in_fit = true;
  return info;
}

constexpr RoleInfo alpha() {
  RoleInfo info{Role::Alpha, "alpha", 1, {1, 3}, Values::Average};
  info.in_fit = true;
  return info;
}

// Reading, --map, --steps, inspect, sweep and the memory estimate read this table. To add a feature pass, see
// docs/dev/add_a_feature_pass.md.
constexpr std::array<RoleInfo, role_count> table{
    color(Role::Beauty, "beauty", true, true),
    showing(Surface::Direction, feature(Role::Normal, "normal", 3, {1, 3}, Noise::Estimated)),
    showing(Surface::Color, feature(Role::Albedo, "albedo", 3, {1, 3}, Noise::Estimated)),
    // An estimate of the depth's noise gains nothing.
    showing(Surface::Distance, feature(Role::Depth, "depth", 1, {1, 2, 3}, Noise::IfKnown, EmptyValue::ZeroOrSky,
                                       FeatureTransform::BoundedDepth)),
    feature(Role::Visibility, "visibility", 1, {1, 2, 3}, Noise::Estimated, EmptyValue::ZeroOrOne),
    description(Role::SpecularAlbedo, "specular-albedo", 3, {3}),
    description(Role::Roughness, "roughness", 1, {1}),
    color(Role::Prior, "prior", true, false),
    RoleInfo{Role::SampleCount, "sample-count", 1, {1, 3}, Values::Count, true, true},
    RoleInfo{Role::Motion, "motion", 4, {4}, Values::Exact, true, false, true},
    alpha(),
    color(Role::Color, "color", false, false),
    RoleInfo{Role::Other, "other", 0, ChannelCounts::any(), Values::Exact, false},
};

constexpr bool rows_are_in_order() {
  for (std::size_t i = 0; i < role_count; ++i)
    if (index_of(table[i].role) != i || table[i].name == nullptr) return false;
  return true;
}
static_assert(rows_are_in_order(), "the table needs a row for each role, in the order of the enumeration");

}  // namespace

const std::array<RoleInfo, role_count>& role_table() { return table; }

std::optional<Role> role_from(const std::string& name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const RoleInfo& info) { return info.name == name; });
  if (found == table.end()) return std::nullopt;
  return found->role;
}

RoleSet feature_roles() {
  RoleSet roles;
  for (const RoleInfo& info : table)
    if (info.feature) roles.insert(info.role);
  return roles;
}

}  // namespace polyrecon
