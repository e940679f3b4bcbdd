#include "io/renderers/known_names.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <unordered_map>
#include <utility>

namespace polyrecon {
namespace {

constexpr std::string_view ignored_in_names = " _-()";  // "Normal (shading)" is NormalShading

std::string normalised(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (ignored_in_names.find(c) == std::string_view::npos)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

using KnownPasses = std::unordered_map<std::string, PassClass>;

/// By normalised name.
const KnownPasses& known_passes() {
  static const KnownPasses known = [] {
    KnownPasses passes;
    std::unordered_map<std::string, const Renderer*> last;  // a renderer may list two spellings of one name
    for (const Renderer& renderer : renderers())
      for (const PassName& pass : renderer.passes) {
        const std::string name = normalised(pass.name);
        const auto [entry, is_new] =
            passes.try_emplace(name, PassClass{pass.role, pass.rank, renderer.name, pass.channels});
        if (!is_new && last[name] != &renderer) entry->second.renderers += ", " + renderer.name;
        last[name] = &renderer;
      }
    return passes;
  }();
  return known;
}

template <typename Condition>
bool any_renderer_with(const Condition& condition) {
  return std::any_of(renderers().begin(), renderers().end(), condition);
}

bool has_role(const std::vector<PassName>& names, Role role) {
  return std::any_of(names.begin(), names.end(), [&](const PassName& known) { return known.role == role; });
}

bool has_name(const std::vector<PassName>& names, Role role, const std::string& name) {
  return std::any_of(names.begin(), names.end(),
                     [&](const PassName& known) { return known.role == role && same_name(known.name, name); });
}

}  // namespace

std::optional<PassClass> classify_pass(const std::string& pass) {
  const auto known = known_passes().find(normalised(pass));
  if (known == known_passes().end()) return std::nullopt;
  return known->second;
}

std::optional<PassClass> classify_letter(const std::string& letter) {
  for (const Renderer& renderer : renderers())
    for (const PassName& known : renderer.letters)
      if (known.name == letter) return PassClass{known.role, known.rank, renderer.name, 1};
  return std::nullopt;
}

std::optional<Role> feature_in_words(const std::string& pass) {
  const std::string name = normalised(pass);
  if (known_passes().count(name) > 0 || has_data_prefix(pass)) return std::nullopt;
  for (const Renderer& renderer : renderers())
    for (const FeatureWord& known : renderer.feature_words)
      if (name.find(known.word) != std::string::npos) return known.role;
  return std::nullopt;
}

bool can_have(const std::string& beauty, Role role) {
  bool is_known = false;
  for (const Renderer& renderer : renderers()) {
    if (!has_name(renderer.passes, Role::Beauty, beauty)) continue;
    is_known = true;
    if (has_role(renderer.passes, role) || has_role(renderer.letters, role)) return true;
  }
  return !is_known;
}

bool same_name(std::string_view a, std::string_view b) { return normalised(a) == normalised(b); }

bool has_data_prefix(const std::string& pass) {
  const std::string name = normalised(pass);
  return any_renderer_with([&](const Renderer& renderer) {
    return std::any_of(renderer.data_prefixes.begin(), renderer.data_prefixes.end(),
                       [&](const std::string& prefix) { return name.compare(0, prefix.size(), prefix) == 0; });
  });
}

bool is_noisy_beauty(const std::string& pass) {
  return any_renderer_with(
      [&](const Renderer& r) { return !r.noisy_beauty.empty() && same_name(pass, r.noisy_beauty); });
}

bool is_sample_fraction(const std::string& pass) {
  return any_renderer_with(
      [&](const Renderer& r) { return !r.sample_fraction.empty() && same_name(pass, r.sample_fraction); });
}

bool is_render_time(const std::string& pass) {
  return any_renderer_with([&](const Renderer& r) { return !r.render_time.empty() && pass == r.render_time; });
}

bool is_divided(const std::string& pass) {
  return any_renderer_with([&](const Renderer& r) {
    return std::any_of(r.divided_passes.begin(), r.divided_passes.end(),
                       [&](const std::string& divided) { return same_name(pass, divided); });
  });
}

bool is_surface_color(const std::string& pass) {
  return any_renderer_with([&](const Renderer& r) {
    return std::any_of(r.surface_colors.begin(), r.surface_colors.end(),
                       [&](const std::string& color) { return same_name(pass, color); });
  });
}

std::string with_view_layer(std::string attribute, const std::string& view_layer) {
  const std::size_t at = attribute.find("{}");
  return at == std::string::npos ? attribute : attribute.replace(at, 2, view_layer);
}

bool names_attribute(const std::string& attribute, const std::string& name, const std::string& view_layer) {
  const std::size_t at = name.find("{}");
  if (at == std::string::npos || !view_layer.empty()) return attribute == with_view_layer(name, view_layer);
  const std::string_view text = attribute, front = std::string_view(name).substr(0, at);
  const std::string_view back = std::string_view(name).substr(at + 2);
  return text.size() > front.size() + back.size() && text.substr(0, front.size()) == front &&
         text.substr(text.size() - back.size()) == back;
}

std::vector<SamplesAttribute> samples_attributes(const std::string& view_layer) {
  std::vector<SamplesAttribute> attributes;
  for (const Renderer& renderer : renderers())
    for (const SamplesAttribute& attribute : renderer.samples_attributes)
      attributes.push_back({with_view_layer(attribute.name, view_layer), attribute.of_sequence});
  return attributes;
}

double sky_value() {
  double least = std::numeric_limits<double>::infinity();
  for (const Renderer& renderer : renderers()) least = std::min(least, renderer.sky_depth);
  return least;
}

double sky_depth() { return sky_value() / 10; }

bool is_compositing_depth(const std::string& pass) {
  return any_renderer_with(
      [&](const Renderer& r) { return !r.compositing_depth.empty() && same_name(pass, r.compositing_depth); });
}

std::vector<std::string> attributes_of_central_samples(const std::string& view_layer) {
  std::vector<std::string> names;
  for (const Renderer& renderer : renderers())
    if (renderer.first_sample_is_central)
      for (const SamplesAttribute& attribute : renderer.samples_attributes)
        names.push_back(with_view_layer(attribute.name, view_layer));
  return names;
}

std::array<Real, 4> motion_factors(const std::string& pass) {
  const Renderer* first = nullptr;
  for (const Renderer& renderer : renderers())
    for (const PassName& known : renderer.passes) {
      if (known.role != Role::Motion) continue;
      if (same_name(known.name, pass)) return renderer.motion_factors;
      if (!first) first = &renderer;
    }
  return first->motion_factors;
}

bool is_other_pass_file(const std::string& word) {
  return any_renderer_with([&](const Renderer& renderer) {
    return std::any_of(renderer.other_pass_files.begin(), renderer.other_pass_files.end(),
                       [&](const std::string& name) { return same_name(name, word); });
  });
}

bool is_written_so(const std::string& pass) {
  return any_renderer_with([&](const Renderer& r) {
    return std::any_of(r.passes.begin(), r.passes.end(), [&](const PassName& known) { return known.name == pass; });
  });
}

bool is_beauty_companion(const std::string& pass) {
  return any_renderer_with([&](const Renderer& r) {
    return std::any_of(r.beauty_companions.begin(), r.beauty_companions.end(),
                       [&](const BeautyCompanion& known) { return known.name == pass; });
  });
}

std::vector<std::string> denoised_endings() {
  std::vector<std::string> endings;
  for (const Renderer& renderer : renderers())
    endings.insert(endings.end(), renderer.denoised_suffixes.begin(), renderer.denoised_suffixes.end());
  return endings;
}

std::vector<std::string> companion_endings() {
  std::vector<std::string> endings;
  for (const Renderer& renderer : renderers())
    for (const CompanionAffix& affix : renderer.affixes)
      if (affix.place == CompanionAffix::Place::BehindPass) endings.push_back(affix.text);
  return endings;
}

}  // namespace polyrecon
