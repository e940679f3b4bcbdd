#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer renderman() {
  Renderer r;
  r.name = "RenderMan";
  r.passes = {
      {"Ci", Role::Beauty, 2},  {"beauty", Role::Beauty, 2},
      {"a", Role::Alpha, 1, 1}, {"albedo", Role::Albedo, 2},
      {"Nn", Role::Normal, 2},  {"normal", Role::Normal, 3},
      {"z", Role::Depth, 2},    {"sampleCount", Role::SampleCount, 1},
      {"P", Role::Other, 1},
  };
  // The statistics that a display channel can have.
  r.affixes = {
      {"_var", Companion::VarianceOfSample},
      {"_mse", Companion::VarianceOfMean},
      {"_even", Companion::HalfA},
      {"_odd", Companion::HalfB},
  };
  r.beauty_companions = {{"mse", Companion::VarianceOfMean}};
  return r;
}

}  // namespace polyrecon
