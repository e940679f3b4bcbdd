#include "io/renderers/renderers.h"

namespace polyrecon {

/// Houdini's renderers, and the names of Hydra's standard passes.
Renderer karma() {
  Renderer r;
  r.name = "Karma";
  r.versions = "Mantra and other renderers in Houdini and Hydra";
  r.passes = {
      {"C", Role::Beauty, 2},          {"beauty", Role::Beauty, 3}, {"color", Role::Beauty, 4},
      {"albedo", Role::Albedo, 2},     {"N", Role::Normal, 3},      {"Neye", Role::Normal, 4},
      {"depth", Role::Depth, 2},       {"Pz", Role::Depth, 3},      {"cameraDepth", Role::Depth, 3},
      {"linearDepth", Role::Depth, 3}, {"Af", Role::Alpha, 2},      {"P", Role::Other, 1},
      {"Of", Role::Other, 1},          {"Ng", Role::Normal, 5},     {"Peye", Role::Other, 1},
      {"hitN", Role::Normal, 3},       {"hitPz", Role::Depth, 3},   {"hitP", Role::Other, 1},
  };
  return r;
}

}  // namespace polyrecon
