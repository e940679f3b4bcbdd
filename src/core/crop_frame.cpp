#include "core/crop_frame.h"

namespace polyrecon {

Pass crop(const Pass& pass, const Rect& r) {
  return {pass.name,
          crop(pass.mean, r),
          crop(pass.variance, r),
          crop(pass.half_a, r),
          crop(pass.half_b, r),
          pass.variance_is_estimated};
}

Frame crop(const Frame& frame, const Rect& r) {
  Frame out;
  const Rect& window = frame.data_window;
  out.data_window = {window.x0 + r.x0, window.y0 + r.y0, window.x0 + r.x1, window.y0 + r.y1};
  out.beauty = crop(frame.beauty, r);
  for (const Feature& feature : frame.features) out.features.push_back({feature.role, crop(feature.pass, r)});
  for (const Pass& aov : frame.aovs) out.aovs.push_back(crop(aov, r));
  out.prior = crop(frame.prior, r);
  out.alpha = crop(frame.alpha, r);
  out.sample_count = crop(frame.sample_count, r);
  out.sky_depth = frame.sky_depth;
  out.motion = crop(frame.motion, r);
  return out;
}

}  // namespace polyrecon
