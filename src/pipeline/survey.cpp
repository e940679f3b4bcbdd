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

}  // namespace

Survey survey_frame(Frame& frame, const Steps& steps, Progress& progress) {
  require_usable(frame);
  Survey survey;
  Image picture = picture_of(frame), sampled = sampled_of(picture, frame);
  hide_void(sampled, frame);
  if (steps.prefilter) estimate_feature_variance(frame, progress, sampled);
  survey.noise = noise_variance(frame, progress, sampled);
  survey.preparation = choose_features(frame, steps, sampled);
  if (!picture.empty()) survey.preparation.decisions.push_back(decide_on_void(picture));
  survey.preparation.picture = std::move(picture);
  survey.preparation.sampled = std::move(sampled);
  return survey;
}

}  // namespace polyrecon
