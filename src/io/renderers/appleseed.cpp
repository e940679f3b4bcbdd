#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer appleseed() {
  Renderer r;
  r.name = "appleseed";
  r.passes = {
      {"beauty", Role::Beauty, 2}, {"RGBA", Role::Beauty, 2}, {"albedo", Role::Albedo, 2},
      {"normal", Role::Normal, 3}, {"depth", Role::Depth, 2}, {"pixel_sample_count", Role::SampleCount, 1},
  };
  return r;
}

}  // namespace polyrecon
