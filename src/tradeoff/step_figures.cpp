// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.142, 1.356},  // draft, order 0
      {0.14, 1.317},   // draft
      {0.344, 1.073},  // draft, stages 2
      {0.283, 1.26},   // stages 1
      {1, 1},          // standard
      {1.19, 0.9818},  // order 3
      {2.11, 0.9708},  // best, coverage 2
      {2.8, 0.9637},   // best
  }};
  return figures;
}

}  // namespace polyrecon
