#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer luxcore() {
  Renderer r;
  r.name = "LuxCore";
  r.versions = "a file for each pass";
  r.passes = {
      {"RGB_IMAGEPIPELINE", Role::Beauty, 2},
      {"RGB_IMAGEPIPELINE_0", Role::Beauty, 2},
      {"RGBA_IMAGEPIPELINE", Role::Beauty, 2},
      {"RGBA_IMAGEPIPELINE_0", Role::Beauty, 2},
      {"ALBEDO", Role::Albedo, 2},
      {"AVG_SHADING_NORMAL", Role::Normal, 1},
      {"SHADING_NORMAL", Role::Normal, 2},
      {"GEOMETRY_NORMAL", Role::Normal, 4},
      {"DEPTH", Role::Depth, 2},
      {"SAMPLECOUNT", Role::SampleCount, 1},
  };
  r.sample_map = {"luxcore",
                  {"Y"},
                  SampleMapFormat::Values::Importance,
                  "in LuxCore, load it into the USER_IMPORTANCE channel and set "
                  "sampler.sobol.adaptive.userimportanceweight to 1"};
  return r;
}

}  // namespace polyrecon
