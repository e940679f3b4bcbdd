#include "io/channel_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <map>
#include <string_view>
#include <tuple>

namespace polyrecon {
namespace {

/// One name of a pass in one renderer. Names are compared without case, blanks, '_' and '-'.
struct KnownPass {
  std::string_view name;
  Role role;
  int rank;  ///< The lowest rank of a role in a view layer is used.
  std::string_view who;
};

constexpr std::array kKnownPasses{
    // Beauty. A noisy image beside a denoised one is the beauty; the denoised one then becomes the prior.
    KnownPass{"noisyimage", Role::Beauty, 1, "Blender"},
    KnownPass{"combined", Role::Beauty, 2, "Blender"},
    KnownPass{"rgba", Role::Beauty, 2, "Arnold, V-Ray, pbrt, Mitsuba, appleseed"},
    KnownPass{"rgb", Role::Beauty, 2, "pbrt, Mitsuba, POV-Ray"},
    KnownPass{"beauty", Role::Beauty, 2, "RenderMan, appleseed"},
    KnownPass{"ci", Role::Beauty, 2, "RenderMan"},
    KnownPass{"rgbcolor", Role::Beauty, 3, "V-Ray"},
    KnownPass{"rgbimagepipeline", Role::Beauty, 2, "LuxCore"},
    KnownPass{"rgbimagepipeline0", Role::Beauty, 2, "LuxCore"},
    KnownPass{"rgbaimagepipeline", Role::Beauty, 2, "LuxCore"},
    KnownPass{"rgbaimagepipeline0", Role::Beauty, 2, "LuxCore"},
    KnownPass{"color", Role::Beauty, 3, "Tungsten"},
    // Already denoised beauty.
    KnownPass{"denoised", Role::Prior, 1, "Blender's compositor"},
    KnownPass{"effectsresult", Role::Prior, 1, "V-Ray"},
    KnownPass{"denoiser", Role::Prior, 2, "V-Ray"},
    KnownPass{"vraydenoiser", Role::Prior, 2, "V-Ray"},
    KnownPass{"prior", Role::Prior, rank_beside, "polyrecon's drivers"},
    KnownPass{"alpha", Role::Alpha, 1, "several renderers"},
    KnownPass{"a", Role::Alpha, 1, "RenderMan"},
    // Features.
    KnownPass{"denoisingalbedo", Role::Albedo, 1, "Blender"},
    KnownPass{"denoisealbedo", Role::Albedo, 1, "Arnold"},
    KnownPass{"albedo", Role::Albedo, 2, "RenderMan, pbrt, Mitsuba, Tungsten, appleseed, LuxCore"},
    KnownPass{"diffusealbedo", Role::Albedo, 3, "Arnold"},
    KnownPass{"diffusefilter", Role::Albedo, 3, "V-Ray"},
    KnownPass{"vraydiffusefilter", Role::Albedo, 3, "V-Ray"},
    KnownPass{"diffcol", Role::Albedo, 4, "Blender"},
    KnownPass{"diffusecolor", Role::Albedo, 4, "Blender 5"},
    KnownPass{"denoisingnormal", Role::Normal, 1, "Blender"},
    KnownPass{"avgshadingnormal", Role::Normal, 1, "LuxCore"},
    KnownPass{"ns", Role::Normal, 2, "pbrt"},
    KnownPass{"shnormal", Role::Normal, 2, "Mitsuba"},
    KnownPass{"nn", Role::Normal, 2, "RenderMan, Mitsuba"},
    KnownPass{"shadingnormal", Role::Normal, 2, "LuxCore"},
    KnownPass{"bumpnormals", Role::Normal, 2, "V-Ray"},
    KnownPass{"normal", Role::Normal, 3, "Blender, RenderMan, Tungsten, appleseed"},
    KnownPass{"normals", Role::Normal, 3, "V-Ray"},
    KnownPass{"n", Role::Normal, 3, "Arnold, pbrt"},
    KnownPass{"geonormal", Role::Normal, 4, "Mitsuba"},
    KnownPass{"geometrynormal", Role::Normal, 4, "LuxCore"},
    KnownPass{"denoisingdepth", Role::Depth, 1, "Blender"},
    KnownPass{"depth", Role::Depth, 2, "Blender, Mitsuba, Tungsten, appleseed, LuxCore"},
    KnownPass{"z", Role::Depth, 2, "Arnold, RenderMan"},
    KnownPass{"zdepth", Role::Depth, 2, "V-Ray"},
    KnownPass{"vrayzdepth", Role::Depth, 2, "V-Ray"},
    KnownPass{"visibility", Role::Visibility, 1, "Tungsten and this program"},
    KnownPass{"shadow", Role::Visibility, 2, "Blender 2.8 - 4, V-Ray"},
    KnownPass{"ambientocclusion", Role::Visibility, 3, "Blender 5"},
    KnownPass{"ao", Role::Visibility, 3, "Blender, Arnold"},
    KnownPass{"samplecount", Role::SampleCount, 1, "RenderMan, LuxCore and this program"},
    KnownPass{"pixelsamplecount", Role::SampleCount, 1, "appleseed"},
    KnownPass{"debugsamplecount", Role::SampleCount, 2, "Blender"},
    // Data with three channels that are no radiance.
    KnownPass{"relativevariance", Role::Other, 1, "pbrt"},
    KnownPass{"position", Role::Other, 1, "several renderers"},
    KnownPass{"p", Role::Other, 1, "Arnold, RenderMan, pbrt"},
    KnownPass{"worldpositions", Role::Other, 1, "V-Ray"},
    KnownPass{"vector", Role::Motion, 1, "Blender"},
    KnownPass{"velocity", Role::Other, 1, "V-Ray"},
    KnownPass{"motionvector", Role::Other, 1, "Arnold"},
    KnownPass{"uv", Role::Other, 1, "several renderers"},
};

/// Whole families of data passes, by how their names begin.
constexpr std::array<std::string_view, 3> kDataPrefixes{"crypto", "index", "debug"};

/// How names of companions are made from the name of their mean.
struct Affix {
  std::string_view text;
  bool prefix;
  Companion companion;
  std::string_view who;
};

constexpr std::array kAffixes{
    Affix{" Variance", false, Companion::VarianceOfMean, "this program's merge"},
    Affix{" A", false, Companion::HalfA, "this program's merge"},
    Affix{" B", false, Companion::HalfB, "this program's merge"},
    Affix{"_variance", false, Companion::VarianceOfMean, "a usual name"},
    Affix{"_var", false, Companion::VarianceOfSample, "RenderMan's variance statistics"},
    Affix{"_mse", false, Companion::VarianceOfMean, "RenderMan's mse statistics"},
    Affix{"_even", false, Companion::HalfA, "RenderMan's even and odd statistics"},
    Affix{"_odd", false, Companion::HalfB, "RenderMan's even and odd statistics"},
    Affix{"m2_", true, Companion::SecondMoment, "Mitsuba's moment integrator"},
    Affix{"Variance", false, Companion::VarianceOfMean, "Tungsten's file names"},
    Affix{"A", false, Companion::HalfA, "Tungsten's file names"},
    Affix{"B", false, Companion::HalfB, "Tungsten's file names"},
};

/// Companions of the beauty that have a name of their own. Case matters: it tells pbrt from Arnold.
struct BeautyCompanion {
  std::string_view name;
  Companion companion;
  std::string_view who;
};

constexpr std::array kBeautyCompanions{
    BeautyCompanion{"Variance", Companion::VarianceOfSample, "pbrt's variance of the samples"},
    BeautyCompanion{"variance", Companion::VarianceOfMean, "Arnold's variance layer"},
    BeautyCompanion{"mse", Companion::VarianceOfMean, "RenderMan's mse statistics"},
};

constexpr std::string_view kNoisySuffix = " Noisy";  ///< What write_result keeps of a replaced layer.
constexpr std::array<std::string_view, 3> kDenoisedSuffixes{"_denoised", "_denoise", " Denoised"};

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool starts_with(std::string_view text, std::string_view begin) { return text.substr(0, begin.size()) == begin; }

std::string normalised(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != ' ' && c != '_' && c != '-') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Place of a channel in its layer: R G B or X Y Z first, then the rest in file order.
int channel_order(std::string_view suffix) {
  static constexpr std::string_view known = "RGBXYZUVW";
  if (suffix.size() != 1) return static_cast<int>(known.size());
  const auto place = known.find(static_cast<char>(std::toupper(static_cast<unsigned char>(suffix[0]))));
  return place == std::string_view::npos ? static_cast<int>(known.size()) : static_cast<int>(place);
}

bool is_bare_color(std::string_view name) { return name == "R" || name == "G" || name == "B" || name == "A"; }

std::string_view channel_suffix(std::string_view name) {
  const auto dot = name.rfind('.');
  return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

/// The layer that a channel belongs to. Channels without a prefix belong to their part where the file has several parts
/// with names (OpenEXR's convention), else R, G, B, A are one layer and any other is one of its own.
std::string layer_of_channel(const FileInfo& file, const PartInfo& part, const std::string& channel) {
  const auto dot = channel.rfind('.');
  if (dot != std::string::npos) return channel.substr(0, dot);
  if (file.parts.size() > 1 && !part.name.empty()) {
    const std::string view_suffix = "." + part.view;
    return !part.view.empty() && ends_with(part.name, view_suffix)
               ? part.name.substr(0, part.name.size() - view_suffix.size())
               : part.name;
  }
  return is_bare_color(channel) ? "RGBA" : channel;
}

/// Takes the stereo view out of a layer's name, if one is in it: "diffuse.left" -> "diffuse" of view "left".
void separate_view(const PartInfo& part, Layer& layer, std::string& name) {
  layer.view = part.view;
  if (part.views.empty()) return;
  const auto dot = name.rfind('.');
  const std::string last = name.substr(dot == std::string::npos ? 0 : dot + 1);
  if (std::find(part.views.begin(), part.views.end(), last) == part.views.end()) {
    layer.view = part.views.front();
    return;
  }
  layer.view = last;
  name = dot == std::string::npos ? "RGBA" : name.substr(0, dot);
}

void order_channels(Layer& layer) {
  std::stable_sort(layer.channels.begin(), layer.channels.end(), [](const std::string& a, const std::string& b) {
    return channel_order(channel_suffix(a)) < channel_order(channel_suffix(b));
  });
  if (layer.channels.size() != 4) return;
  const auto alpha = std::find_if(layer.channels.begin(), layer.channels.end(), [](const std::string& name) {
    return channel_suffix(name) == "A" || channel_suffix(name) == "a";
  });
  if (alpha == layer.channels.end() || channel_order(channel_suffix(layer.channels[0])) != 0) return;
  layer.alpha = *alpha;
  layer.channels.erase(alpha);
}

std::vector<Layer> group_channels(const FileInfo& file) {
  std::vector<Layer> layers;
  std::map<std::string, int> uses;
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    const PartInfo& part = file.parts[p];
    const std::size_t first = layers.size();
    for (const ChannelInfo& channel : part.channels) {
      const std::string full = layer_of_channel(file, part, channel.name);
      auto found = std::find_if(layers.begin() + static_cast<std::ptrdiff_t>(first), layers.end(),
                                [&](const Layer& l) { return l.name == full; });
      if (found == layers.end()) {
        Layer layer;
        layer.name = full;
        layer.part = static_cast<int>(p);
        std::string name = full;
        separate_view(part, layer, name);
        const auto dot = name.rfind('.');
        if (dot != std::string::npos) layer.view_layer = name.substr(0, dot);
        layer.pass = name.substr(dot == std::string::npos ? 0 : dot + 1);
        layers.push_back(std::move(layer));
        found = std::prev(layers.end());
      }
      found->channels.push_back(channel.name);
    }
    for (std::size_t l = first; l < layers.size(); ++l) {
      order_channels(layers[l]);
      ++uses[layers[l].name];
    }
  }
  for (Layer& layer : layers)
    if (uses[layer.name] > 1)
      layer.name = fmt::format("{}:{}", file.parts[static_cast<std::size_t>(layer.part)].name, layer.name);
  return layers;
}

bool all_uint(const std::vector<FileInfo>& files, const Layer& layer) {
  const auto& channels =
      files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)].channels;
  return std::all_of(layer.channels.begin(), layer.channels.end(), [&](const std::string& name) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const ChannelInfo& c) { return c.name == name && c.type == SampleType::Uint; });
  });
}

bool fits(Role role, const Layer& layer) { return info_of(role).layer_channels.allow(layer.channels.size()); }

bool is_color(const Layer& layer) {
  return layer.channels.size() == 3 && channel_order(channel_suffix(layer.channels[0])) == 0;
}

void assign_role(const std::vector<FileInfo>& files, Layer& layer) {
  const auto known = classify_pass(layer.pass);
  if (known && fits(known->role, layer)) {
    layer.role = known->role;
    layer.rank = known->rank;
    layer.why = fmt::format("named as by {}", known->who);
    return;
  }
  const std::string name = normalised(layer.pass);
  const bool data =
      std::any_of(kDataPrefixes.begin(), kDataPrefixes.end(), [&](std::string_view p) { return starts_with(name, p); });
  const bool color = !data && is_color(layer) && !all_uint(files, layer);
  layer.role = color ? Role::Color : Role::Other;
  layer.why = color ? "a colour pass" : "data";
}

bool same_place(const Layer& a, const Layer& b) { return a.view_layer == b.view_layer && a.view == b.view; }

const Layer* find_pass(const std::vector<Layer>& layers, const Layer& beside, std::string_view pass) {
  const auto found = std::find_if(layers.begin(), layers.end(),
                                  [&](const Layer& l) { return same_place(l, beside) && l.pass == pass; });
  return found == layers.end() ? nullptr : &*found;
}

/// The mean of a Mitsuba second moment: "m2_" stands before the whole name, "m2_aov.albedo" belongs to "aov.albedo".
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

bool is_half(Companion companion) { return companion == Companion::HalfA || companion == Companion::HalfB; }

/// Halves count only where the other half is there: "Light A" alone is a light group.
bool other_half_exists(const std::vector<Layer>& layers, const Layer& layer, std::string_view base,
                       const Affix& affix) {
  return std::any_of(kAffixes.begin(), kAffixes.end(), [&](const Affix& other) {
    return other.who == affix.who && is_half(other.companion) && other.companion != affix.companion &&
           find_pass(layers, layer, std::string(base).append(other.text)) != nullptr;
  });
}

void find_companions(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    for (const Affix& affix : kAffixes) {
      const std::string& full = affix.prefix ? layer.name : layer.pass;
      if (full.size() <= affix.text.size() ||
          !(affix.prefix ? starts_with(full, affix.text) : ends_with(full, affix.text)))
        continue;
      const std::string base =
          affix.prefix ? full.substr(affix.text.size()) : full.substr(0, full.size() - affix.text.size());
      const Layer* mean = affix.prefix ? find_whole_name(layers, layer, base) : find_pass(layers, layer, base);
      if (!mean || mean == &layer || !same_channels(*mean, layer)) continue;
      if (is_half(affix.companion) && !other_half_exists(layers, layer, base, affix)) continue;
      make_companion(layer, *mean, affix.companion, affix.who);
      break;
    }
  }
}

bool is_beauty_mean(const Layer& layer) { return layer.role == Role::Beauty && layer.companion == Companion::Mean; }

void find_beauty_companions(std::vector<Layer>& layers) {
  for (Layer& layer : layers)
    for (const BeautyCompanion& known : kBeautyCompanions) {
      if (layer.pass != known.name || layer.companion != Companion::Mean) continue;
      const auto beauty = std::find_if(layers.begin(), layers.end(), [&](const Layer& l) {
        return is_beauty_mean(l) && same_place(l, layer) && same_channels(l, layer);
      });
      if (beauty != layers.end()) make_companion(layer, *beauty, known.companion, known.who);
    }
}

/// "<beauty>_denoised" is a prior; "<layer> Noisy" takes over the role of its layer, whose result is then a prior.
void find_denoised(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    for (const std::string_view suffix : kDenoisedSuffixes) {
      if (!ends_with(layer.pass, suffix)) continue;
      const Layer* base = find_pass(layers, layer, layer.pass.substr(0, layer.pass.size() - suffix.size()));
      if (!base || base->role != Role::Beauty || !fits(Role::Prior, layer)) continue;
      layer.role = Role::Prior;
      layer.rank = 1;
      layer.why = fmt::format("{} after a denoiser", base->name);
    }
    if (!ends_with(layer.pass, kNoisySuffix)) continue;
    const Layer* base = find_pass(layers, layer, layer.pass.substr(0, layer.pass.size() - kNoisySuffix.size()));
    if (!base || base->channels.size() != layer.channels.size()) continue;
    layer.role = base->role;
    layer.rank = base->rank - 1;
    layer.why = fmt::format("{} before it was denoised", base->name);
  }
  for (const Layer& noisy : std::vector<Layer>(layers)) {
    const bool blender = normalised(noisy.pass) == "noisyimage";
    if (!is_beauty_mean(noisy) || !(blender || ends_with(noisy.pass, kNoisySuffix))) continue;
    for (Layer& layer : layers)
      if (is_beauty_mean(layer) && same_place(layer, noisy) && layer.rank > noisy.rank) {
        layer.role = Role::Prior;
        layer.why = fmt::format("stands beside {}", noisy.name);
      }
  }
}

/// Mitsuba's moment integrator gives the image itself no second moment, but the nested integrator that makes it: a
/// layer with alpha and with the same channels as the beauty.
void find_nested_moment(std::vector<Layer>& layers) {
  const auto beauty =
      std::find_if(layers.begin(), layers.end(), [](const Layer& l) { return is_beauty_mean(l) && l.pass == "RGBA"; });
  if (beauty == layers.end()) return;
  for (Layer& moment : layers) {
    if (moment.companion != Companion::SecondMoment) continue;
    const Layer* nested = find_whole_name(layers, moment, moment.of);
    if (nested && nested->role == Role::Color && !nested->alpha.empty() && !moment.alpha.empty()) {
      make_companion(moment, *beauty, Companion::SecondMoment,
                     fmt::format("Mitsuba's nested integrator {}", nested->name));
      return;
    }
  }
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

const char* name_of(Companion companion) {
  static constexpr std::array names{
      "mean", "variance of the mean", "variance of one sample", "second moment", "half A", "half B"};
  return names[static_cast<std::size_t>(companion)];
}

std::optional<PassClass> classify_pass(const std::string& pass) {
  const std::string name = normalised(pass);
  const auto known =
      std::find_if(kKnownPasses.begin(), kKnownPasses.end(), [&](const KnownPass& k) { return k.name == name; });
  if (known == kKnownPasses.end()) return std::nullopt;
  return PassClass{known->role, known->rank, std::string(known->who)};
}

std::vector<Layer> find_layers(const FileInfo& file) {
  std::vector<Layer> layers = group_channels(file);
  classify_layers({file}, layers);
  return layers;
}

void classify_layers(const std::vector<FileInfo>& files, std::vector<Layer>& layers) {
  for (Layer& layer : layers) assign_role(files, layer);
  find_denoised(layers);
  find_companions(layers);
  find_beauty_companions(layers);
  find_nested_moment(layers);
}

bool is_sample_fraction(const Layer& layer) { return normalised(layer.pass) == "debugsamplecount"; }

std::optional<double> samples_in_metadata(const FileInfo& file, const std::string& view_layer) {
  for (const std::string& name : {fmt::format("polyrecon/{}/samples", view_layer),
                                  fmt::format("cycles.{}.samples", view_layer), std::string("samplesPerPixel")})
    if (const auto value = number_in(file, name)) return value;
  return std::nullopt;
}

}  // namespace polyrecon
