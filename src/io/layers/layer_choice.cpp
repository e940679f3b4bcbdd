#include "io/layers/layer_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/layers/channel_names.h"
#include "io/layers/layer_search.h"

namespace polyrecon {
namespace {

/// The companion of a mean that is wanted(companion): one that the user named, else the first in the file; -1 without
/// one.
template <class Wanted>
int find_companion(const FrameSource& source, const Layer& mean, Wanted wanted) {
  int best = -1;
  for (std::size_t i = 0; i < source.layers.size(); ++i) {
    const Layer& layer = source.layers[i];
    const bool by_hand = layer.rank == rank_by_hand && layer.of.empty() && layer.role == mean.role;
    if (!wanted(layer.companion) || !part_of(source, layer).readable()) continue;
    if (!by_hand && (layer.of != mean.name || layer.view != mean.view)) continue;
    if (by_hand) return static_cast<int>(i);
    if (best < 0) best = static_cast<int>(i);
  }
  return best;
}

/// Why a layer of a file that was found next to the input, and that nobody named, is no pass of it; empty where it is.
std::string found_misfit(const FrameSource& source, const Layer& layer, const Layer& beauty) {
  const Rect &picture = part_of(source, beauty).display_window, &other = part_of(source, layer).display_window;
  if (layer.file == 0 || layer.rank == rank_by_hand || other == picture) return {};
  return fmt::format(
      "its picture has {} x {} pixels, that of the beauty {} x {}; --map ROLE={} lays it over the beauty",
      other.width(), other.height(), picture.width(), picture.height(),
      source.files[static_cast<std::size_t>(layer.file)].path);
}

}  // namespace

PassChoice with_companions(const FrameSource& source, Role role, int mean) {
  const Layer& layer = source.layers[static_cast<std::size_t>(mean)];
  PassChoice pass{role, mean};
  pass.variance = find_companion(source, layer, is_variance);
  pass.half_a = find_companion(source, layer, [](Companion c) { return c == Companion::HalfA; });
  pass.half_b = find_companion(source, layer, [](Companion c) { return c == Companion::HalfB; });
  return pass;
}

void require_both_halves(LayerChoice& choice, PassChoice& pass) {
  if ((pass.half_a < 0) == (pass.half_b < 0)) return;
  const Layer& half = choice.source.layers[static_cast<std::size_t>(std::max(pass.half_a, pass.half_b))];
  if (half.rank == rank_by_hand)
    choice.notes.push_back(fmt::format("{} is not used: it is one half without the other, which --map {}{}=LAYER names",
                                       half.name,
                                       pass.role == Role::Beauty ? "" : fmt::format("{}-", name_of(pass.role)),
                                       pass.half_a < 0 ? "half-a" : "half-b"));
  pass.half_a = pass.half_b = -1;
}

void drop_misfits(LayerChoice& choice, PassChoice& pass) {
  const FrameSource& source = choice.source;
  const Layer& beauty = source.layers[static_cast<std::size_t>(choice.passes.front().mean)];
  for (int* index : {&pass.variance, &pass.half_a, &pass.half_b, &pass.mean}) {
    if (*index < 0) continue;
    const Layer& layer = source.layers[static_cast<std::size_t>(*index)];
    std::string why = misfit(part_of(source, layer), part_of(source, beauty));
    if (why.empty()) why = found_misfit(source, layer, beauty);
    if (why.empty()) continue;
    choice.notes.push_back(fmt::format("{} is not used: {}", layer.name, why));
    *index = -1;
  }
  require_both_halves(choice, pass);
}

}  // namespace polyrecon
