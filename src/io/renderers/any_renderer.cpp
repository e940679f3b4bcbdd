#include "io/renderers/renderers.h"

namespace polyrecon {

/// Names that several renderers and studios use.
Renderer any_renderer() {
  Renderer r;
  r.name = "any renderer";
  r.passes = {
      {"base_color", Role::Albedo, 4}, {"world_normal", Role::Normal, 3},
      {"Alpha", Role::Alpha, 1},       {"Position", Role::Other, 1},
      {"UV", Role::Other, 1},
  };
  r.feature_words = {{"normal", Role::Normal},       {"albedo", Role::Albedo},        {"basecolor", Role::Albedo},
                     {"diffusecolor", Role::Albedo}, {"diffusefilter", Role::Albedo}, {"depth", Role::Depth}};
  r.data_prefixes = {"crypto"};  // Cryptomatte
  r.affixes = {{"_variance", Companion::VarianceOfMean}};
  r.denoised_suffixes = {"_denoised", "_denoise", " Denoised"};
  return r;
}

}  // namespace polyrecon
