#include "polyrecon/params.h"

#include <algorithm>

#include "polyrecon/error.h"
#include "regression/basis.h"

namespace polyrecon {
namespace {

void require(bool holds, const char* message) {
  if (!holds) throw Error(ExitCode::Usage, message);
}

}  // namespace

Params params_for(Quality quality) {
  Params params;
  if (quality == Quality::Draft) {
    params.stages = 1;
    params.levels = 2;
    params.radius = 6;
    params.stride = 5;
    params.coverage = 0.25;
    params.max_order = 1;
    params.prefilter.search_radius = 2;
    params.prefilter.patch_radius = 2;
    params.denoiser = {0, false};
  } else if (quality == Quality::Best) {
    params.radius = 11;
    params.stride = 3;
    params.coverage = 6;
    params.max_order = 4;
    params.denoiser.mean_runs = 4;
  }
  return params;
}

void validate(const Params& params) {
  require(params.stages >= 1 && params.stages <= 4, "the number of stages must be 1 to 4");
  require(params.levels >= 1 && params.levels <= 5, "the number of levels must be 1 to 5");
  require(params.radius >= 1 && params.radius <= 20, "the window radius must be 1 to 20 pixels");
  require(params.stride >= 1 && params.stride <= params.radius, "the stride must be 1 pixel to the window radius");
  require(params.enough >= 0, "the error that is enough must not be negative");
  for (const int radius : {params.patch.radius, params.estimated_patch.radius})
    require(radius >= 0 && radius <= 4, "the patch radius must be 0 to 4 pixels");
  require(params.max_order >= 0 && params.max_order <= BasisLayout::max_order, "the order must be 0 to 4");
  require(params.outliers.neighbourhood >= 1 && params.outliers.neighbourhood <= 10,
          "the neighbourhood of an outlier must be 1 to 10 pixels");
  require(params.outliers.density_radius >= 1, "the radius within which outliers are counted must be positive");
  require(params.denoiser.mean_runs >= 0 && params.denoiser.mean_runs <= 4, "a denoiser runs 0 to 4 times on the mean");
  require(params.temporal.radius >= 0 && params.temporal.radius <= 8, "the frame radius must be 0 to 8 frames");
  require(!params.first_bandwidths.empty() && !params.later_bandwidths.empty(), "each stage needs a bandwidth");
  for (const auto* bandwidths : {&params.first_bandwidths, &params.later_bandwidths, &params.guided_bandwidths}) {
    for (const Real h : *bandwidths) require(h > 0, "a bandwidth must be positive");
    require(std::is_sorted(bandwidths->begin(), bandwidths->end()), "bandwidths must rise");
  }
}

}  // namespace polyrecon
