#include "io/layers/channel_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "io/renderers/known_names.h"
#include "polyrecon/roles.h"

namespace polyrecon {
namespace {

using Letters = std::array<std::string_view, 4>;  ///< The channels of a colour or a vector, then alpha.

constexpr std::array<Letters, 4> color_letters{
    {{"R", "G", "B", "A"}, {"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}, {"Red", "Green", "Blue", "Alpha"}}};
constexpr std::array<Letters, 2> vector_letters{{{"X", "Y", "Z", "A"}, {"x", "y", "z", "a"}}};
using Eyes = std::array<std::string_view, 2>;
constexpr Eyes eyes{"left", "right"};  // OpenEXR's names of the views of a stereo render
constexpr std::array<Eyes, 3> eyes_of_parts{{eyes, {"L", "R"}, {"l", "r"}}};
constexpr std::string_view layer_separators = "._ -:/";

bool is_layer_separator(char c) { return layer_separators.find(c) != std::string_view::npos; }

/// R G B come first, then X Y Z and U V W, then everything else. `word` is a letter or the name of a colour.
int place_of(std::string_view word) {
  static constexpr std::string_view known = "RGBXYZUVW";
  std::string lower;
  for (const char c : word) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (std::size_t c = 0; c < 3; ++c)
    if (lower == color_letters[2][c]) return static_cast<int>(c);
  if (lower.size() != 1) return static_cast<int>(known.size());
  const auto place = known.find(static_cast<char>(std::toupper(static_cast<unsigned char>(lower[0]))));
  return place == std::string_view::npos ? static_cast<int>(known.size()) : static_cast<int>(place);
}

bool is_alpha(std::string_view word) {
  return std::any_of(color_letters.begin(), color_letters.end(), [&](const Letters& l) { return l[3] == word; });
}

/// The views of a part, and the one of the channels that name none.
struct PartViews {
  std::vector<std::string> names;
  std::string of_the_rest;

  bool has(std::string_view name) const { return std::find(names.begin(), names.end(), name) != names.end(); }
};

/// The text without the view at its end or its beginning: "rgba_left" and "left.rgba" become "rgba".
std::string without_view(const std::string& text, const std::string& view) {
  if (view.empty() || text.size() < view.size()) return text;
  if (text == view) return {};
  const std::size_t rest = text.size() - view.size();
  if (text.compare(rest, view.size(), view) == 0 && is_layer_separator(text[rest - 1])) return text.substr(0, rest - 1);
  if (text.compare(0, view.size(), view) == 0 && is_layer_separator(text[view.size()]))
    return text.substr(view.size() + 1);
  return text;
}

/// Whether the name of a part only counts parts, as OpenImageIO's "subimage03" does.
bool only_counts(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const std::string word = name.substr(0, digits);
  return digits < name.size() && (word == "subimage" || word == "part");
}

/// Takes the view out of a name of words with dots between them: it is the last word (OpenEXR) or the first (Nuke).
std::string take_view(const PartViews& views, std::string& name) {
  const std::string last(after_last_dot(name)), first = name.substr(0, name.find('.'));
  for (const std::string& word : {last, first})
    if (views.has(word)) {
      name = without_view(name, word);
      return word;
    }
  return views.of_the_rest;
}

/// The eye that a part has by its name where another part is that of the other eye: "rgba_left" next to "rgba_right".
std::string eye_by_name(const FileInfo& file, const PartInfo& part) {
  for (const Eyes& pair : eyes_of_parts)
    for (std::size_t e = 0; e < pair.size(); ++e) {
      std::string eye(pair[e]);
      const std::string other(pair[1 - e]), rest = without_view(part.name, eye);
      if (rest == part.name) continue;
      for (const PartInfo& candidate : file.parts)
        if (candidate.name != part.name && without_view(candidate.name, other) == rest) return eye;
    }
  return {};
}

bool is_feature(const std::string& name) {
  const auto known = classify_pass(std::string(after_last_dot(name)));
  return known && info_of(known->role).feature;
}

/// The eyes of a part that does not say which views it has. One layer called "right" may be a light; two are an eye,
/// and so are "left" and "right" where no other colour can be the beauty.
PartViews eyes_in_names(const PartInfo& part) {
  std::map<std::string, std::set<std::string>> layers;  // of each eye, without it
  bool others = false;
  for (const ChannelInfo& channel : part.channels) {
    const auto dot = channel.name.rfind('.');
    if (dot == std::string::npos) {
      others |= place_of(channel.name) == 0;
      continue;
    }
    std::string name = channel.name.substr(0, dot);
    const std::string eye = take_view({{eyes.begin(), eyes.end()}, {}}, name);
    if (!eye.empty())
      layers[eye].insert(name);
    else
      others |= place_of(channel.name.substr(dot + 1)) == 0 && !is_feature(name);
  }
  const bool stereo = (layers.size() == eyes.size() && !others) ||
                      std::any_of(layers.begin(), layers.end(), [](const auto& eye) { return eye.second.size() > 1; });
  if (!stereo) return {};
  PartViews views{{eyes.begin(), eyes.end()}, {}};
  if (layers.size() == 1) views.of_the_rest = eyes[layers.begin()->first == eyes[0] ? 1 : 0];
  return views;
}

PartViews views_of(const FileInfo& file, const PartInfo& part) {
  if (!part.views.empty()) return {part.views, part.view.empty() ? part.views.front() : part.view};
  const std::string view = part.view.empty() ? eye_by_name(file, part) : part.view;
  return view.empty() ? eyes_in_names(part) : PartViews{{view}, view};
}

/// The channels of one part by their names.
class PartChannels {
 public:
  PartChannels(const FileInfo& file, const PartInfo& part) : views_(views_of(file, part)) {
    for (const ChannelInfo& channel : part.channels) names_.insert(channel.name);
    if (file.parts.size() > 1) title_ = part.name;
    if (!title_.empty()) {
      const std::string rest = without_view(title_, views_.of_the_rest);
      title_ = rest.empty() ? bare_pass : rest;
    }
    find_bare();
    const bool has_prefixes = std::any_of(part.channels.begin(), part.channels.end(), [](const ChannelInfo& channel) {
      return channel.name.find('.') != std::string::npos;
    });
    title_is_layer_ = !title_.empty() && !has_bare_color() && !has_prefixes && !only_counts(title_);
  }

  const PartViews& views() const { return views_; }
  const std::string& title() const { return title_; }  ///< The part's name without its view; empty if names have none.
  bool has_bare_color() const { return bare_pass_ == bare_pass; }

  /// The layer of a channel, and the word that says which channel of it.
  std::pair<std::string, std::string> split(const std::string& channel) const {
    const auto dot = channel.rfind('.');
    // An empty name stands for no layer elsewhere, so ".R" is of a layer "."
    if (dot != std::string::npos) return {channel.substr(0, std::max<std::size_t>(dot, 1)), channel.substr(dot + 1)};
    if (bare_.count(channel) > 0) return {title_.empty() ? bare_pass_ : title_, channel};
    if (auto glued = split_glued(channel); !glued.first.empty()) return glued;
    return {title_is_layer_ ? title_ : channel, channel};
  }

 private:
  bool has(std::string_view name) const { return names_.count(name) > 0; }

  bool has_all(std::string_view stem, const Letters& letters) const {
    return std::all_of(letters.begin(), letters.begin() + 3,
                       [&](std::string_view letter) { return has(std::string(stem) + std::string(letter)); });
  }

  void take_bare(const std::string& pass, const Letters& letters, std::size_t colors) {
    bare_pass_ = pass;
    for (std::size_t c = 0; c < letters.size(); ++c)
      if ((c < colors || c == 3) && has(letters[c])) bare_.insert(std::string(letters[c]));
  }

  /// Finds the colour, the tristimulus values or the luminance without a layer name, with the alpha that belongs to it.
  /// An A alone is no colour.
  void find_bare() {
    for (const Letters& letters : color_letters)
      if (has_all("", letters)) return take_bare(bare_pass, letters, 3);
    if (has("R") || has("G") || has("B")) return take_bare(bare_pass, color_letters[0], 3);
    if (has_all("", vector_letters[0])) return take_bare(bare_tristimulus, vector_letters[0], 3);
    if (has("Y") && !has("X")) take_bare(bare_luminance, {"Y", "", "", "A"}, 1);
  }

  /// "AlbedoR" becomes "Albedo" and "R" where the part has the other letters too; both are empty otherwise.
  std::pair<std::string, std::string> split_glued(const std::string& channel) const {
    const auto split_by = [&](const Letters& letters) -> std::pair<std::string, std::string> {
      for (const std::string_view letter : letters) {
        if (!ends_with(channel, letter)) continue;
        const std::string stem = channel.substr(0, channel.size() - letter.size());
        std::string name = stem;
        while (!name.empty() && is_layer_separator(name.back())) name.pop_back();
        const auto dotted = names_.lower_bound(name + ".");
        const bool taken = dotted != names_.end() && dotted->compare(0, name.size() + 1, name + ".") == 0;
        if (!name.empty() && !taken && has_all(stem, letters)) return {name, std::string(letter)};
      }
      return {};
    };
    for (const Letters& letters : color_letters)
      if (auto found = split_by(letters); !found.first.empty()) return found;
    for (const Letters& letters : vector_letters)
      if (auto found = split_by(letters); !found.first.empty()) return found;
    return {};
  }

  PartViews views_;
  std::set<std::string, std::less<>> names_, bare_;
  std::string title_, bare_pass_;
  bool title_is_layer_ = false;  ///< Channels that are neither a colour nor have a prefix are those of title().
};

/// A layer while its channels are collected.
struct Group {
  Layer layer;
  std::vector<std::string> words;  ///< Name of each channel within the layer.
};

/// Puts R G B, then X Y Z in front and takes the alpha channel of such a layer out of it.
void order_channels(Group& group) {
  std::vector<std::size_t> order(group.words.size());
  for (std::size_t c = 0; c < order.size(); ++c) order[c] = c;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return place_of(group.words[a]) < place_of(group.words[b]); });
  std::vector<std::string> channels, words;
  for (const std::size_t c : order) {
    channels.push_back(group.layer.channels[c]);
    words.push_back(group.words[c]);
  }
  const bool of_color = words.size() > 1 && place_of(words[words.size() - 2]) < 6;  // all others are R G B X Y Z
  if (of_color && is_alpha(words.back())) {
    group.layer.alpha = channels.back();
    channels.pop_back();
  }
  group.layer.channels = std::move(channels);
}

/// Whether the words are those of a colour and of features, as in "right.R", "right.G", "right.B", "right.Z".
bool is_color_with_features(const std::vector<std::string>& words) {
  std::size_t colors = 0;
  for (const std::string& word : words) {
    const auto known = classify_pass(word);
    const bool color = place_of(word) < 3;
    if (!color && !is_alpha(word) && !(known && info_of(known->role).feature)) return false;
    colors += color;
  }
  return colors == 3 && words.size() > 3;
}

/// Makes the features among the channels of a colour layers of their own, in the colour's view layer and view.
void split_features(std::vector<Group>& groups) {
  std::vector<Group> split;
  for (Group& group : groups) {
    if (!is_color_with_features(group.words)) {
      split.push_back(std::move(group));
      continue;
    }
    Group color{group.layer, {}};
    color.layer.channels.clear();
    std::vector<Group> features;
    for (std::size_t c = 0; c < group.words.size(); ++c) {
      const std::string &word = group.words[c], &channel = group.layer.channels[c];
      Group* target = &color;
      if (place_of(word) >= 3 && !is_alpha(word)) {
        target = &features.emplace_back(Group{group.layer, {}});
        target->layer.name = channel;
        target->layer.pass = word;
        target->layer.channels.clear();
      }
      target->layer.channels.push_back(channel);
      target->words.push_back(word);
    }
    split.push_back(std::move(color));
    split.insert(split.end(), features.begin(), features.end());
  }
  groups = std::move(split);
}

Layer named_layer(const PartChannels& part, const std::string& name, int index) {
  Layer layer;
  layer.name = name;
  layer.part = index;
  std::string rest = name;
  layer.view = take_view(part.views(), rest);
  if (rest.empty()) rest = bare_pass;
  const auto dot = rest.rfind('.');
  if (dot != std::string::npos) layer.view_layer = rest.substr(0, dot);
  layer.pass = rest.substr(dot == std::string::npos ? 0 : dot + 1);
  return layer;
}

std::vector<Layer> layers_of(const PartInfo& part, const PartChannels& channels, int index) {
  std::vector<Group> groups;
  for (const ChannelInfo& channel : part.channels) {
    auto [name, word] = channels.split(channel.name);
    auto found = std::find_if(groups.begin(), groups.end(),
                              [&, &wanted = name](const Group& g) { return g.layer.name == wanted; });
    if (found == groups.end()) found = groups.insert(groups.end(), {named_layer(channels, name, index), {}});
    found->layer.channels.push_back(channel.name);
    found->words.push_back(std::move(word));
  }
  split_features(groups);
  std::vector<Layer> layers;
  for (Group& group : groups) {
    order_channels(group);
    layers.push_back(std::move(group.layer));
  }
  return layers;
}

/// Whether the part holds a view layer of its own: a bare colour and other layers, as another part of its view does.
bool is_view_layer(const std::vector<PartChannels>& parts, const std::vector<std::vector<Layer>>& layers,
                   std::size_t part) {
  const auto whole = [&](std::size_t p) {
    return parts[p].has_bare_color() && !parts[p].title().empty() && layers[p].size() > 1;
  };
  if (!whole(part)) return false;
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (p != part && whole(p) && parts[p].views().of_the_rest == parts[part].views().of_the_rest &&
        parts[p].title() != parts[part].title())
      return true;
  return false;
}

/// Makes the part's name the view layer of its layers.
void make_view_layer(const std::string& title, std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    if (layer.name == title) layer.pass = bare_pass;
    layer.view_layer = layer.view_layer.empty() || layer.name == title ? title : title + "." + layer.view_layer;
  }
}

/// Puts the part's name in front of names that several parts use.
void make_unique(const FileInfo& file, std::vector<Layer>& layers) {
  std::map<std::string, int> uses;
  for (const Layer& layer : layers) ++uses[layer.name];
  for (Layer& layer : layers)
    if (uses[layer.name] > 1)
      layer.name = fmt::format("{}:{}", file.parts[static_cast<std::size_t>(layer.part)].name, layer.name);
}

}  // namespace

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

std::string_view after_last_dot(std::string_view name) {
  const auto dot = name.rfind('.');
  return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

std::vector<Layer> group_channels(const FileInfo& file) {
  std::vector<PartChannels> parts;
  std::vector<std::vector<Layer>> layers;
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    parts.emplace_back(file, file.parts[p]);
    layers.push_back(layers_of(file.parts[p], parts.back(), static_cast<int>(p)));
  }
  std::vector<Layer> all;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (is_view_layer(parts, layers, p)) make_view_layer(parts[p].title(), layers[p]);
    all.insert(all.end(), layers[p].begin(), layers[p].end());
  }
  make_unique(file, all);
  return all;
}

std::string word_of(const Layer& layer, const std::string& channel) {
  std::string word(after_last_dot(channel));
  if (word.size() < channel.size() || word.compare(0, layer.pass.size(), layer.pass) != 0) return word;
  std::size_t begin = layer.pass.size();
  while (begin < word.size() && is_layer_separator(word[begin])) ++begin;
  return begin < word.size() ? word.substr(begin) : word;
}

bool is_bare(const Layer& layer) {
  const std::string& channel = layer.channels.front();
  return std::any_of(color_letters.begin(), color_letters.end(), [&](const Letters& l) { return l[0] == channel; });
}

bool is_rgb(const Layer& layer) {
  if (layer.channels.size() != 3) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string_view word = after_last_dot(layer.channels[c]);
    const bool dotted = word.size() < layer.channels[c].size();
    const bool ends_in_it = std::any_of(color_letters.begin(), color_letters.end(),
                                        [&](const Letters& letters) { return ends_with(word, letters[c]); });
    if (place_of(word) != static_cast<int>(c) && (dotted || !ends_in_it)) return false;
  }
  return true;
}

}  // namespace polyrecon
