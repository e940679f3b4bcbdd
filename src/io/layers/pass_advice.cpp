#include "io/layers/pass_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "io/layers/layer_words.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

/// The loss where no pass shows a property of the surfaces, the worst first (docs/guide/passes.md has the figures).
/// Other features are written by too few renderers, or bring too little.
struct Loss {
  Surface unseen;
  const char* without;
};
constexpr std::array losses{Loss{Surface::Color, "textures blur"}, Loss{Surface::Direction, "edges soften"},
                            Loss{Surface::Distance, "outlines run together"}};

std::string letters_of(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (const auto byte = static_cast<unsigned char>(c); std::isalnum(byte))
      out += static_cast<char>(std::tolower(byte));
  return out;
}

/// Whether the header says that this program wrote the file.
bool says_so(const PartInfo& part, const Renderer& renderer, const std::string& view_layer) {
  static const std::set<std::string> about_the_program{"software", "renderer", "creator", "generatedby", "appname"};
  const std::string name = letters_of(renderer.name);
  for (const AttributeInfo& attribute : part.attributes) {
    const std::string about = letters_of(attribute.name);
    if (about.find(name) != std::string::npos) return true;
    if (about_the_program.count(about) > 0 && letters_of(attribute.value).find(name) != std::string::npos) return true;
    for (const SamplesAttribute& samples : renderer.samples_attributes)
      if (names_attribute(attribute.name, samples.name, view_layer)) return true;
  }
  return false;
}

/// How many layers of the file have names just as this renderer writes them.
std::size_t known_layers(const FrameSource& source, const Renderer& renderer) {
  const auto is_known = [&](const Layer& layer) {
    return std::any_of(renderer.passes.begin(), renderer.passes.end(),
                       [&](const PassName& pass) { return pass.name == layer.pass; });
  };
  return static_cast<std::size_t>(std::count_if(source.layers.begin(), source.layers.end(), is_known));
}

/// The renderer that made the file, by its header or by the names of its layers; null where these do not tell.
const Renderer* renderer_of(const FrameSource& source) {
  const Renderer* best = nullptr;
  std::size_t most = 0;
  for (const Renderer& renderer : renderers()) {
    if (renderer.switches.empty()) continue;
    for (const FileInfo& file : source.files)
      for (const PartInfo& part : file.parts)
        if (says_so(part, renderer, source.view_layer)) return &renderer;
    const std::size_t known = known_layers(source, renderer);
    if (known > most)
      best = &renderer;
    else if (known == most)
      best = nullptr;
    most = std::max(most, known);
  }
  return best;
}

bool has(const FrameSource& source, Role role) {
  return std::any_of(source.chosen.begin(), source.chosen.end(), [&](const RoleChoice& c) { return c.role == role; });
}

bool noise_is_known(const FrameSource& source) {
  return std::any_of(source.chosen.begin(), source.chosen.end(),
                     [](const RoleChoice& c) { return c.role == Role::Beauty && c.companion != Companion::Mean; });
}

constexpr const char* aov = "aov";

/// Up to so many samples per pixel a network lowers the error (docs/lab/2026-12-01-second-opinion.md).
constexpr double few_samples = 64;

/// The light AOVs of the picture, where none of them is denoised.
std::size_t noisy_aovs(const FrameSource& source) {
  if (has(source, Role::Color)) return 0;
  return static_cast<std::size_t>(std::count_if(source.layers.begin(), source.layers.end(), [&](const Layer& layer) {
    return is_light_aov(layer) && layer.view_layer == source.view_layer && layer.view == source.view;
  }));
}

std::string how_to(const FrameSource& source, const Renderer* renderer, Role role) {
  const bool one_layer = source.layers.size() == 1 && source.view_layer.empty();
  if (renderer)
    for (const PassSwitch& one : renderer->switches)
      if (one.role == role)
        return renderer->name + ": " +
               (one_layer && !renderer->many_layers.empty() ? renderer->many_layers + ", " : "") + one.place;
  return "render such passes";
}

}  // namespace

std::vector<PassAdvice> pass_advice(const FrameSource& source, double samples, bool oidn_is_installed) {
  std::vector<PassAdvice> advice;
  if (source.chosen.empty()) return advice;
  const Renderer* renderer = renderer_of(source);
  for (const Loss& loss : losses)
    for (const RoleInfo& info : role_table())
      if (info.surface == loss.unseen && !has(source, info.role))
        advice.push_back({info.name, loss.without, how_to(source, renderer, info.role)});
  if (!noise_is_known(source))
    advice.push_back({"variance", "the noise is estimated from the picture",
                      renderer && !renderer->noise_switch.empty()
                          ? renderer->name + ": " + renderer->noise_switch
                          : "render parts with different seeds and join them by polyrecon merge"});
  if (samples > 0 && samples <= few_samples && !has(source, Role::Prior))
    advice.push_back({name_of(Role::Prior), fmt::format("{:.4g} samples per pixel are few", samples),
                      oidn_is_installed ? "--prior oidn" : "--prior oidn, after pip install pyoidn"});
  const std::size_t aovs = noisy_aovs(source);
  if (aovs > 0)
    advice.push_back({aov, fmt::format("{} light AOV{} noisy", aovs, aovs == 1 ? " stays" : "s stay"), "--aov all"});
  return advice;
}

std::vector<std::string> advice_lines(const std::vector<PassAdvice>& advice) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < advice.size();) {
    std::string names, without;
    const std::string& how = advice[i].how;
    for (; i < advice.size() && advice[i].how == how; ++i) {
      if (advice[i].pass != aov && advice[i].pass != name_of(Role::Prior))
        names += (names.empty() ? "no " : ", ") + advice[i].pass;
      without += (without.empty() ? "" : ", ") + advice[i].without;
    }
    lines.push_back(fmt::format("{}{} ({})", names.empty() ? "" : names + ": ", without, how));
  }
  return lines;
}

}  // namespace polyrecon
