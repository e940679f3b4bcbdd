#include "pipeline/survey.h"

namespace polyrecon {

Survey survey_frame(Frame& frame, const Steps& steps, Progress& progress) {
  require_usable(frame);
  if (steps.prefilter) estimate_feature_variance(frame, progress);
  return {noise_variance(frame, progress), look_at(frame, steps)};
}

}  // namespace polyrecon
