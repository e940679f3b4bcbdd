#include "pipeline/survey.h"

#include <fmt/format.h>

#include <utility>

#include "core/mask.h"
#include "core/void_pixels.h"

namespace polyrecon {
namespace {

Decision decide_on_void(const Image& rendered) {
  const std::size_t all = rendered.pixels();
  const double share = 1 - static_cast<double>(mask_pixels(rendered, all)) / static_cast<double>(all);
  return {"void pixels skipped", true,
          fmt::format("{:.1f} % of the frame: alpha, features and all colours are 0", 100 * share)};
}

Decision decide_on_lamps(const Lamps& lamps) {
  return {"lamps kept", true,
          fmt::format("{} pixels, so much brighter than those around that they keep their values, and no window "
                      "contains them",
                      lamps.pixels.size())};
}

Decision decide_on_correlation(double correlation) {
  return {"correlated noise", true,
          fmt::format("the pixel filter spreads samples: noise of neighbours correlates by {:.2f}", correlation)};
}

Decision decide_on_edges() {
  return {"noise at edges", false, "the sample count is unknown, which bounds it; give --samples"};
}

}  // namespace

Survey survey_frame(Frame& frame, const Steps& steps, Progress& progress) {
  require_usable(frame);
  Survey survey;
  Image rendered = rendered_mask(frame), sampled = sampled_mask(rendered, frame);
  Lamps lamps = find_lamps(frame, rendered);
  sampled = both_masks(sampled, lamps.others);
  hide_void(sampled, frame);
  const double correlation = noise_is_measured(frame) ? 0 : noise_correlation(frame, progress, sampled);
  if (steps.prefilter) estimate_feature_variance(frame, progress, sampled, correlation);
  survey.noise = noise_variance(frame, progress, sampled, correlation);
  survey.preparation = choose_features(frame, steps, sampled);
  if (!rendered.empty()) survey.preparation.decisions.push_back(decide_on_void(rendered));
  if (!lamps.empty()) survey.preparation.decisions.push_back(decide_on_lamps(lamps));
  survey.preparation.noise_correlation = correlation;
  if (correlation > 0) survey.preparation.decisions.push_back(decide_on_correlation(correlation));
  if (!survey.noise.measured && frame.sample_count.empty()) survey.preparation.decisions.push_back(decide_on_edges());
  survey.preparation.rendered = std::move(rendered);
  survey.preparation.sampled = std::move(sampled);
  survey.preparation.lamps = std::move(lamps);
  return survey;
}

}  // namespace polyrecon
