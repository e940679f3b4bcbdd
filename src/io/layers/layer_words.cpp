#include "io/layers/layer_words.h"

#include <fnmatch.h>

#include <algorithm>

#include "io/renderers/known_names.h"

namespace polyrecon {

std::vector<std::string> layer_words(const std::string& text, const std::vector<Layer>& layers) {
  const auto is_named = [&](const Layer& layer) { return layer.name == text || layer.pass == text; };
  if (std::any_of(layers.begin(), layers.end(), is_named)) return {text};
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    if (comma > begin) words.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return words.empty() ? std::vector<std::string>{text} : words;
}

bool is_layer_pattern(const std::string& word) { return word.find_first_of("*?") != std::string::npos; }

bool fits_pattern(const Layer& layer, const std::string& pattern) {
  return ::fnmatch(pattern.c_str(), layer.name.c_str(), 0) == 0 ||
         ::fnmatch(pattern.c_str(), layer.pass.c_str(), 0) == 0;
}

bool is_light_aov(const Layer& layer) {
  return layer.role == Role::Color && layer.companion == Companion::Mean && layer.file == 0 &&
         info_of(Role::Color).layer_channels.allow(layer.channels.size()) && !is_surface_color(layer.pass);
}

}  // namespace polyrecon
