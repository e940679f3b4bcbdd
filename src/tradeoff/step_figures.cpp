// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.125, 1.307},  // draft, order 0
      {0.136, 1.282},  // draft
      {0.334, 1.097},  // draft, stages 2
      {0.303, 1.196},  // stages 1
      {1, 1},          // standard
      {1.71, 1.001},   // stages 3
      {2.91, 0.9623},  // best, stages 2
      {4.83, 0.9649},  // best
  }};
  return figures;
}

}  // namespace polyrecon
