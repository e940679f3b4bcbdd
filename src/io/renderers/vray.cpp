#include "io/renderers/renderers.h"

namespace polyrecon {

/// Render elements; in exported scenes their names begin with "VRay".
Renderer vray() {
  Renderer r;
  r.name = "V-Ray";
  r.passes = {
      {"RGBA", Role::Beauty, 2},
      {"RGB color", Role::Beauty, 3},
      {"effectsResult", Role::Prior, 1},
      {"denoiser", Role::Prior, 2},
      {"VRayDenoiser", Role::Prior, 2},
      {"diffuseFilter", Role::Albedo, 3},
      {"VRayDiffuseFilter", Role::Albedo, 3},
      {"bumpNormals", Role::Normal, 2},
      {"VRayBumpNormals", Role::Normal, 2},
      {"normals", Role::Normal, 3},
      {"VRayNormals", Role::Normal, 3},
      {"Z-Depth", Role::Depth, 2},
      {"VRayZDepth", Role::Depth, 2},
      {"shadow", Role::Visibility, 2},
      {"worldPositions", Role::Other, 1},
      {"velocity", Role::Other, 1},
  };
  r.sample_map = {"vray",
                  {"R", "G", "B"},
                  SampleMapFormat::Values::Mask,
                  "in V-Ray, use it as the render mask texture (V-Ray takes no sample counts)"};
  r.switches = {
      {Role::Albedo, "render element Diffuse Filter"},
      {Role::Normal, "render element Bump Normals"},
      {Role::Depth, "render element Z-Depth"},
  };
  return r;
}

}  // namespace polyrecon
