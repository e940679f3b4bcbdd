#include "io/layers/channel_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "io/layers/channel_groups.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"

namespace polyrecon {
namespace {

bool fits(Role role, const Layer& layer) { return info_of(role).layer_channels.allow(layer.channels.size()); }

/// Whether the layer is a picture in CIE XYZ or a grey one.
bool is_bare_film(const Layer& layer) {
  return layer.view_layer.empty() && (layer.pass == bare_tristimulus || layer.pass == bare_luminance);
}

/// The class of a layer by its name, else by the letter of its only channel.
std::optional<PassClass> classify(const Layer& layer) {
  if (auto known = classify_pass(layer.pass);
      known && (known->channels == 0 || known->channels == layer.channels.size()))
    return known;
  if (layer.channels.size() != 1 || layer.channels.front() == layer.name) return std::nullopt;
  return classify_letter(std::string(after_last_dot(layer.channels.front())));
}

void assign_role(const std::vector<FileInfo>& files, Layer& layer) {
  if (is_bare_film(layer)) {
    layer.role = Role::Beauty;
    layer.rank = last_rank;
    layer.why = layer.pass == bare_luminance ? "a grey picture" : "a picture in CIE XYZ";
    return;
  }
  const auto known = classify(layer);
  if (known && fits(known->role, layer)) {
    layer.role = known->role;
    layer.rank = known->rank;
    layer.why = fmt::format("named as by {}", known->renderers);
    return;
  }
  const bool color = !has_data_prefix(layer.pass) && is_rgb(layer) && !all_uint(files, layer);
  layer.role = color ? Role::Color : Role::Other;
  layer.why = color ? "a colour pass" : "data";
}

bool same_place(const Layer& a, const Layer& b) { return a.view_layer == b.view_layer && a.view == b.view; }

/// The layer with this pass in the same view layer and view; nullptr where there is none.
const Layer* find_pass(const std::vector<Layer>& layers, const Layer& neighbour, std::string_view pass) {
  const auto found = std::find_if(layers.begin(), layers.end(),
                                  [&](const Layer& l) { return same_place(l, neighbour) && l.pass == pass; });
  return found == layers.end() ? nullptr : &*found;
}

/// The layer with this whole name in the same view; nullptr where there is none.
const Layer* find_whole_name(const std::vector<Layer>& layers, const Layer& layer, std::string_view name) {
  const auto found = std::find_if(layers.begin(), layers.end(),
                                  [&](const Layer& l) { return l.view == layer.view && l.name == name; });
  return found == layers.end() ? nullptr : &*found;
}

bool same_channels(const Layer& mean, const Layer& companion) {
  return companion.channels.size() == mean.channels.size() || companion.channels.size() == 1;
}

void make_companion(Layer& layer, const Layer& mean, Companion companion, std::string_view who) {
  layer.companion = companion;
  layer.of = mean.name;
  layer.role = mean.role;
  layer.rank = mean.rank;
  layer.why = fmt::format("{} of {} ({})", name_of(companion), mean.name, who);
}

/// The layer's names without the affix: passes, or whole names if it stands before a word. Empty where it has none.
std::vector<std::string> names_without(const CompanionAffix& affix, const Layer& layer) {
  const std::string &text = affix.text, &name = layer.name, &pass = layer.pass;
  if (affix.place == CompanionAffix::Place::BehindPass) {
    if (pass.size() <= text.size() || !ends_with(pass, text)) return {};
    return {pass.substr(0, pass.size() - text.size())};
  }
  std::vector<std::string> names;
  std::size_t word = 0;
  do {
    if (name.compare(word, text.size(), text) == 0 && name.size() > word + text.size())
      names.push_back(name.substr(0, word) + name.substr(word + text.size()));
    word = name.find('.', word) + 1;  // 0 behind the last word
  } while (word > 0);
  return names;
}

/// Whether the companion of the other half exists. Without it the layer is no half: "Key A" alone is a light group.
bool other_half_exists(const std::vector<Layer>& layers, const Layer& layer, const std::string& base,
                       const Renderer& renderer, Companion half) {
  return std::any_of(renderer.affixes.begin(), renderer.affixes.end(), [&](const CompanionAffix& other) {
    return is_half(other.companion) && other.companion != half &&
           find_pass(layers, layer, base + other.text) != nullptr;
  });
}

/// Makes the layer a companion by the first affix of the renderer that leads to a mean.
bool find_mean_by_affix(const std::vector<Layer>& layers, const Renderer& renderer, Layer& layer) {
  for (const CompanionAffix& affix : renderer.affixes)
    for (const std::string& base : names_without(affix, layer)) {
      const Layer* mean = affix.place == CompanionAffix::Place::BeforeWord ? find_whole_name(layers, layer, base)
                                                                           : find_pass(layers, layer, base);
      if (!mean || mean == &layer || !same_channels(*mean, layer)) continue;
      if (is_half(affix.companion) && !other_half_exists(layers, layer, base, renderer, affix.companion)) continue;
      make_companion(layer, *mean, affix.companion, renderer.name);
      return true;
    }
  return false;
}

void find_companions(std::vector<Layer>& layers) {
  for (Layer& layer : layers)
    for (const Renderer& renderer : renderers())
      if (find_mean_by_affix(layers, renderer, layer)) break;
}

bool is_beauty_mean(const Layer& layer) { return layer.role == Role::Beauty && layer.companion == Companion::Mean; }

void find_beauty_companions(std::vector<Layer>& layers) {
  for (Layer& layer : layers)
    for (const Renderer& renderer : renderers())
      for (const BeautyCompanion& known : renderer.beauty_companions) {
        if (layer.pass != known.name || layer.companion != Companion::Mean) continue;
        const auto beauty = std::find_if(layers.begin(), layers.end(), [&](const Layer& l) {
          return is_beauty_mean(l) && same_place(l, layer) && same_channels(l, layer);
        });
        if (beauty != layers.end()) make_companion(layer, *beauty, known.companion, renderer.name);
      }
}

/// The layer whose name has the suffix behind this one's pass removed, or nullptr.
const Layer* find_without(const std::vector<Layer>& layers, const Layer& layer, std::string_view suffix) {
  if (suffix.empty() || !ends_with(layer.pass, suffix)) return nullptr;
  return find_pass(layers, layer, layer.pass.substr(0, layer.pass.size() - suffix.size()));
}

/// "<beauty>_denoised" is a prior.
void make_prior_by_suffix(const std::vector<Layer>& layers, const Renderer& renderer, Layer& layer) {
  for (const std::string& suffix : renderer.denoised_suffixes) {
    const Layer* base = find_without(layers, layer, suffix);
    if (!base || base->role != Role::Beauty || !fits(Role::Prior, layer)) continue;
    layer.role = Role::Prior;
    layer.rank = 1;
    layer.why = fmt::format("{} after a denoiser", base->name);
  }
}

/// "<layer> Noisy" takes over the role of its layer.
void take_role_of_denoised(const std::vector<Layer>& layers, const Renderer& renderer, Layer& layer) {
  const Layer* base = find_without(layers, layer, renderer.noisy_suffix);
  if (!base || base->channels.size() != layer.channels.size()) return;
  layer.role = base->role;
  layer.rank = base->rank - 1;
  layer.why = fmt::format("{} before it was denoised", base->name);
}

bool is_noisy_next_to_denoised(const Layer& layer) {
  return is_beauty_mean(layer) &&
         (is_noisy_beauty(layer.pass) || std::any_of(renderers().begin(), renderers().end(), [&](const Renderer& r) {
            return !r.noisy_suffix.empty() && ends_with(layer.pass, r.noisy_suffix);
          }));
}

/// Finds the priors: by the suffixes of denoised layers, and the beauties next to one that is kept noisy.
void find_denoised(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    for (const Renderer& renderer : renderers()) make_prior_by_suffix(layers, renderer, layer);
    for (const Renderer& renderer : renderers()) take_role_of_denoised(layers, renderer, layer);
  }
  for (const Layer& noisy : std::vector<Layer>(layers)) {
    if (!is_noisy_next_to_denoised(noisy)) continue;
    for (Layer& layer : layers)
      if (is_beauty_mean(layer) && same_place(layer, noisy) && layer.rank > noisy.rank) {
        layer.role = Role::Prior;
        layer.why = fmt::format("next to {}", noisy.name);
      }
  }
}

bool is_xyz(const Layer& layer) {
  static constexpr std::array letters{"X", "Y", "Z"};
  return std::equal(layer.channels.begin(), layer.channels.end(), letters.begin(), letters.end(),
                    [](const std::string& channel, const char* letter) { return after_last_dot(channel) == letter; });
}

/// The companion of the beauty that a second moment of `nested` is: nested has alpha like a picture in RGB, or it is
/// the nested integrator itself, whose picture is kept in CIE XYZ whatever the film. Nothing for other layers.
std::optional<Companion> moment_of_beauty(const Layer& beauty, const Layer& nested, const Layer& moment) {
  const bool of_rgb = nested.role == Role::Color && !nested.alpha.empty() && !moment.alpha.empty();
  if (of_rgb && !is_bare_film(beauty)) return Companion::SecondMoment;
  const bool is_output = moment.pass == nested.pass;  // of the nested integrator: "m2_img.pos" of "img.pos"
  if (nested.role != Role::Other || is_output || !is_xyz(nested)) return std::nullopt;
  return is_bare_film(beauty) ? Companion::SecondMoment : Companion::SecondMomentOfXyz;
}

/// The beauty's second moment where it accompanies a nested layer. One of its RGB is preferred; one of a grey beauty is
/// that of Y.
void find_nested_moment(const Renderer& renderer, std::vector<Layer>& layers) {
  if (!renderer.beauty_moment_is_nested) return;
  const auto beauty = std::find_if(layers.begin(), layers.end(),
                                   [](const Layer& l) { return is_beauty_mean(l) && is_bare_name(l.pass); });
  if (beauty == layers.end()) return;
  for (const Companion wanted : {Companion::SecondMoment, Companion::SecondMomentOfXyz})
    for (Layer& moment : layers) {
      if (moment.companion != Companion::SecondMoment) continue;
      const Layer* nested = find_whole_name(layers, moment, moment.of);
      if (!nested || moment_of_beauty(*beauty, *nested, moment) != wanted) continue;
      if (beauty->pass == bare_luminance) moment.channels = {moment.channels[1]};
      make_companion(moment, *beauty, wanted, fmt::format("{}'s nested integrator {}", renderer.name, nested->name));
      return;
    }
}

/// A file without a beauty by name has the first colour without a layer name for it: parts called "subimage00", "rgb".
void find_beauty_without_name(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    const bool known = std::any_of(layers.begin(), layers.end(), [&](const Layer& other) {
      return other.role == Role::Beauty && other.view == layer.view;
    });
    if (known || layer.role != Role::Color || !is_rgb(layer) || !is_bare(layer)) continue;
    layer.pass = bare_pass;
    layer.role = Role::Beauty;
    layer.rank = last_rank;
    layer.why = "the first colour without a layer name";
  }
}

/// Whether the attribute holds the samples per pixel of some view layer.
bool is_samples_attribute(const std::string& name) {
  return std::any_of(renderers().begin(), renderers().end(), [&](const Renderer& renderer) {
    return std::any_of(renderer.samples_attributes.begin(), renderer.samples_attributes.end(),
                       [&](const SamplesAttribute& attribute) { return names_attribute(name, attribute.name, ""); });
  });
}

std::optional<double> number_in(const FileInfo& file, const std::string& attribute) {
  for (const PartInfo& part : file.parts)
    if (const AttributeInfo* found = find_attribute(part, attribute)) {
      char* end = nullptr;
      const double value = std::strtod(found->value.c_str(), &end);
      if (end != found->value.c_str() && value > 0) return value;
    }
  return std::nullopt;
}

}  // namespace

bool all_uint(const std::vector<FileInfo>& files, const Layer& layer) {
  const auto& channels =
      files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)].channels;
  return std::all_of(layer.channels.begin(), layer.channels.end(), [&](const std::string& name) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const ChannelInfo& c) { return c.name == name && c.type == SampleType::Uint; });
  });
}

const char* name_of(Companion companion) {
  switch (companion) {
    case Companion::Mean:
      return "mean";
    case Companion::VarianceOfMean:
      return "variance of the mean";
    case Companion::VarianceOfSample:
      return "variance of one sample";
    case Companion::SecondMoment:
      return "second moment";
    case Companion::SecondMomentOfXyz:
      return "second moment of CIE XYZ";
    case Companion::HalfA:
      return "half A";
    case Companion::HalfB:
      return "half B";
  }
  return "";
}

std::string name_of(const LayerView& place) {
  std::string name = place.view_layer.empty() ? "" : "view layer " + place.view_layer;
  if (place.view.empty()) return name;
  return name + (name.empty() ? "" : ", ") + "view " + place.view;
}

std::vector<Layer> find_layers(const FileInfo& file) {
  std::vector<Layer> layers = group_channels(file);
  classify_layers({file}, layers);
  return layers;
}

void classify_layers(const std::vector<FileInfo>& files, std::vector<Layer>& layers) {
  for (Layer& layer : layers) assign_role(files, layer);
  find_beauty_without_name(layers);
  find_denoised(layers);
  find_companions(layers);
  find_beauty_companions(layers);
  for (const Renderer& renderer : renderers()) find_nested_moment(renderer, layers);
}

bool adopt_only_color(std::vector<Layer>& layers) {
  const auto is_color = [](const Layer& l) { return l.role == Role::Color && l.companion == Companion::Mean; };
  const auto first = std::find_if(layers.begin(), layers.end(), is_color);
  if (first == layers.end() || std::count_if(layers.begin(), layers.end(), is_color) != 1) return false;
  const std::string name = first->name;
  for (Layer& layer : layers)
    if (layer.name == name || layer.of == name) {
      layer.role = Role::Beauty;
      layer.rank = last_rank;
    }
  first->why = "the only colour layer";
  return true;
}

const Layer* picture_layer(const std::vector<Layer>& layers) {
  const Layer* best = nullptr;
  const auto key = [](const Layer& l) { return std::make_pair(l.role != Role::Prior, l.rank); };
  for (const Layer& layer : layers) {
    const bool denoised = layer.role == Role::Prior && layer.rank != rank_of_made_prior;
    if (layer.companion != Companion::Mean || !(denoised || layer.role == Role::Beauty)) continue;
    if (!best || (same_place(layer, *best) && key(layer) < key(*best))) best = &layer;
  }
  return best;
}

std::optional<NamedCompanion> variance_by_name(const Layer& layer) {
  for (const Renderer& renderer : renderers())
    for (const CompanionAffix& affix : renderer.affixes)
      if (is_variance(affix.companion))
        if (const auto names = names_without(affix, layer); !names.empty())
          return NamedCompanion{affix.companion, names.front()};
  return std::nullopt;
}

bool is_picture_in_xyz(const Layer& layer) { return is_bare_film(layer) && layer.pass == bare_tristimulus; }

bool may_lose_precision(const Layer& layer) {
  const RoleInfo& info = info_of(layer.role);
  return layer.companion == Companion::Mean && (info.values == Values::Radiance || info.surface == Surface::Color);
}

bool is_result(const FileInfo& file) {
  return std::any_of(file.parts.begin(), file.parts.end(),
                     [](const PartInfo& part) { return find_attribute(part, settings_attribute) != nullptr; });
}

std::optional<double> samples_in_metadata(const FileInfo& file, const std::string& view_layer) {
  for (const SamplesAttribute& attribute : samples_attributes(view_layer))
    if (const auto value = number_in(file, attribute.name)) return value;
  if (!view_layer.empty()) return std::nullopt;
  std::optional<double> only;  // A file of one layer, whose view layer is named by the attribute alone.
  for (const AttributeInfo& attribute : file.parts.front().attributes)
    if (is_samples_attribute(attribute.name)) {
      if (only) return std::nullopt;
      only = number_in(file, attribute.name);
    }
  return only;
}

}  // namespace polyrecon
