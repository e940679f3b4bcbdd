#include "io/renderers/renderers.h"

namespace polyrecon {

/// Render elements by the names of their classes.
Renderer corona() {
  Renderer r;
  r.name = "Corona";
  r.passes = {
      {"RGBA", Role::Beauty, 2},
      {"Beauty", Role::Beauty, 2},
      {"CShading_Albedo", Role::Albedo, 2},
      {"CShading_SourceColor", Role::Albedo, 3},
      {"CGeometry_NormalsShading", Role::Normal, 2},
      {"CGeometry_NormalsGeometry", Role::Normal, 4},
      {"CGeometry_ZDepth", Role::Depth, 2},
      {"CGeometry_WorldPosition", Role::Other, 1},
  };
  return r;
}

}  // namespace polyrecon
