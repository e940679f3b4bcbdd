#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer redshift() {
  Renderer r;
  r.name = "Redshift";
  r.passes = {
      {"RGBA", Role::Beauty, 2},
      {"Beauty", Role::Beauty, 2},
      {"DiffuseFilter", Role::Albedo, 3},
      {"BumpNormals", Role::Normal, 2},
      {"N", Role::Normal, 3},
      {"Normals", Role::Normal, 3},
      {"Z", Role::Depth, 2},
      {"Depth", Role::Depth, 2},
      {"AO", Role::Visibility, 3},
      {"P", Role::Other, 1},
      {"ID", Role::Other, 1},
      {"MotionVectors", Role::Other, 1},
      {"ObjectPosition", Role::Other, 1},
  };
  r.data_prefixes = {"puzzlematte"};
  return r;
}

}  // namespace polyrecon
