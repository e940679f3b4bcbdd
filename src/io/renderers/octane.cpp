#include "io/renderers/renderers.h"

namespace polyrecon {

/// Octane's own layers and those of its plugins; names that begin with "Oct" are those of older plugins.
Renderer octane() {
  Renderer r;
  r.name = "Octane";
  r.passes = {
      {"Beauty", Role::Beauty, 2},
      {"Main", Role::Beauty, 3},
      {"OctBeauty", Role::Beauty, 3},
      {"Denoised Beauty", Role::Prior, 1},
      {"DeMain", Role::Prior, 2},
      {"OctDenoiserBeauty", Role::Prior, 2},
      {"DiffuseFilterInfo", Role::Albedo, 2},
      {"OctDiffFilterInfo", Role::Albedo, 2},
      {"DiffuseFilter", Role::Albedo, 3},
      {"OctDiffFilter", Role::Albedo, 3},
      {"Shading Normal", Role::Normal, 2},
      {"NormalShading", Role::Normal, 2},
      {"OctShadingNormal", Role::Normal, 2},
      {"NormalSmooth", Role::Normal, 3},
      {"Smooth Normal", Role::Normal, 3},
      {"OctSmoothNormal", Role::Normal, 3},
      {"NormalGeometric", Role::Normal, 4},
      {"Geometric Normal", Role::Normal, 4},
      {"OctGeoNormal", Role::Normal, 4},
      {"Z-Depth", Role::Depth, 2},
      {"OctZDepth", Role::Depth, 2},
      {"Ambient Occlusion", Role::Visibility, 3},
      {"NormalTangent", Role::Other, 1},
      {"Tangent Normal", Role::Other, 1},
      {"OctTangentNormal", Role::Other, 1},
      {"OctPosition", Role::Other, 1},
  };
  return r;
}

}  // namespace polyrecon
