#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer appleseed() {
  Renderer r;
  r.name = "appleseed";
  r.passes = {
      {"beauty", Role::Beauty, 2}, {"RGBA", Role::Beauty, 2}, {"albedo", Role::Albedo, 2},
      {"normal", Role::Normal, 3}, {"depth", Role::Depth, 2}, {"pixel_sample_count", Role::SampleCount, 1},
  };
  r.sample_map = {"appleseed",
                  {"R"},
                  SampleMapFormat::Values::Importance,
                  "in appleseed, set texture_controlled_pixel_renderer's min_samples to 0 and max_samples to {max}"};
  return r;
}

}  // namespace polyrecon
