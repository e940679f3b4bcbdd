#include "pipeline/survey.h"

#include <fmt/format.h>

#include <utility>

#include "core/picture.h"
#include "core/picture_mask.h"

namespace polyrecon {
namespace {

Decision decide_on_void(const Image& picture) {
  const std::size_t all = picture.pixels();
  const double share = 1 - static_cast<double>(picture_pixels(picture, all)) / static_cast<double>(all);
  return {"void pixels skipped", true,
          fmt::format("{:.1f} % of the frame: alpha, features and all colours are 0", 100 * share)};
}

Decision decide_on_correlation(double correlation) {
  return {"correlated noise", true,
          fmt::format("the pixel filter spreads samples: noise of neighbours correlates by {:.2f}", correlation)};
}

}  // namespace

Survey survey_frame(Frame& frame, const Steps& steps, Progress& progress) {
  require_usable(frame);
  Survey survey;
  Image picture = picture_of(frame), sampled = sampled_of(picture, frame);
  hide_void(sampled, frame);
  const double correlation = noise_is_measured(frame) ? 0 : noise_correlation(frame, progress, sampled);
  if (steps.prefilter) estimate_feature_variance(frame, progress, sampled, correlation);
  survey.noise = noise_variance(frame, progress, sampled, correlation);
  survey.preparation = choose_features(frame, steps, sampled);
  if (!picture.empty()) survey.preparation.decisions.push_back(decide_on_void(picture));
  survey.preparation.noise_correlation = correlation;
  if (correlation > 0) survey.preparation.decisions.push_back(decide_on_correlation(correlation));
  survey.preparation.picture = std::move(picture);
  survey.preparation.sampled = std::move(sampled);
  return survey;
}

}  // namespace polyrecon
