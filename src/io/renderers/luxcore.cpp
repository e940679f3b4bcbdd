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
  r.other_pass_files = {
      "EMISSION", "IRRADIANCE",  "CAUSTIC", "DIRECT_SHADOW_MASK", "INDIRECT_SHADOW_MASK", "POSITION", "UV",
      "RAYCOUNT", "CONVERGENCE", "NOISE",   "MATERIAL_ID",        "MATERIAL_ID_COLOR",    "OBJECT_ID"};
  for (const char* light :
       {"DIRECT_DIFFUSE", "DIRECT_GLOSSY", "INDIRECT_DIFFUSE", "INDIRECT_GLOSSY", "INDIRECT_SPECULAR"})
    for (const char* lobe : {"", "_REFLECT", "_TRANSMIT"}) r.other_pass_files.push_back(std::string(light) + lobe);
  r.data_prefixes = {"position", "materialid", "objectid", "convergence", "raycount"};
  r.sample_map = {"luxcore",
                  {"Y"},
                  SampleMapFormat::Values::Importance,
                  "in LuxCore, load it into the USER_IMPORTANCE channel and set "
                  "sampler.sobol.adaptive.userimportanceweight to 1"};
  r.switches = {
      {Role::Albedo, "film output ALBEDO"},
      {Role::Normal, "film output AVG_SHADING_NORMAL"},
      {Role::Depth, "film output DEPTH"},
  };
  return r;
}

}  // namespace polyrecon
