#include "io/renderers/polyrecon.h"

#include "io/renderers/renderers.h"

namespace polyrecon {

/// Names that `polyrecon merge`, `polyrecon denoise` and the drivers in pipelines/ write.
Renderer polyrecon_itself() {
  Renderer r;
  r.name = "polyrecon";
  r.versions = "merge, denoise and the drivers";
  r.passes = {
      {"Prior", Role::Prior, rank_of_made_prior},
      {"Visibility", Role::Visibility, 1},
      {sample_count_pass, Role::SampleCount, 1},
  };
  r.affixes = {
      {variance_suffix, Companion::VarianceOfMean},
      {half_a_suffix, Companion::HalfA},
      {half_b_suffix, Companion::HalfB},
  };
  r.noisy_suffix = noisy_suffix;
  r.samples_attributes = {{samples_attribute}};
  return r;
}

}  // namespace polyrecon
