#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer tungsten() {
  Renderer r;
  r.name = "Tungsten";
  r.versions = "a file for each pass";
  r.passes = {
      {"color", Role::Beauty, 3}, {"albedo", Role::Albedo, 2},         {"normal", Role::Normal, 3},
      {"depth", Role::Depth, 2},  {"visibility", Role::Visibility, 1},
  };
  r.affixes = {
      {"Variance", Companion::VarianceOfMean},
      {"A", Companion::HalfA},
      {"B", Companion::HalfB},
  };
  return r;
}

}  // namespace polyrecon
