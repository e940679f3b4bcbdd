#include "io/layers/result_layers.h"

#include "io/layers/channel_names.h"
#include "io/renderers/renderers.h"

namespace polyrecon {
namespace {

/// Whether a layer of the input file holds the picture: a prior that the user named, or that stands in another file, is
/// no part of it.
bool is_picture(const Layer& layer, Role role) {
  return layer.file == 0 && (role == Role::Beauty || (layer.rank != rank_by_hand && layer.rank != rank_of_made_prior));
}

}  // namespace

std::string result_layer(const FrameSource& source, const std::string& beauty) {
  for (const Role role : {Role::Prior, Role::Beauty})
    for (const RoleChoice& choice : source.chosen) {
      if (choice.role != role || choice.companion != Companion::Mean) continue;
      for (const Layer& layer : source.layers)
        if (layer.name == choice.layer && is_picture(layer, role)) return layer.name;
    }
  return beauty;
}

std::string alpha_layer(const FrameSource& source, const std::string& beauty, const std::string& picture) {
  if (source.alpha_layer != beauty) return source.alpha_layer;
  for (const Layer& layer : source.layers)
    if (layer.name == picture && layer.file == 0 && !layer.alpha.empty()) return picture;
  return source.alpha_layer;
}

}  // namespace polyrecon
