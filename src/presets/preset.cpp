#include "presets/preset.h"

namespace polyrecon {

std::array<Preset, preset_count> presets() {
  const Params draft = params_for(Quality::Draft), standard = params_for(Quality::Standard);
  const Params best = params_for(Quality::Best);
  const auto changed = [](Params params, const auto& change) {
    change(params);
    return params;
  };
  return {{{"draft, order 0", changed(draft, [](Params& p) { p.max_order = 0; })},
           {"draft", draft},
           {"draft, stages 2", changed(draft,
                                       [](Params& p) {
                                         p.stages = 2;
                                         p.later_bandwidths = {Real(0.5)};
                                       })},
           {"stages 1", changed(standard, [](Params& p) { p.stages = 1; })},
           {"standard", standard},
           {"order 3", changed(standard, [](Params& p) { p.max_order = 3; })},
           {"best, coverage 2", changed(best, [](Params& p) { p.coverage = 2; })},
           {"best", best}}};
}

}  // namespace polyrecon
