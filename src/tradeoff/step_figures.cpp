// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.117, 1.356},  // draft, order 0
      {0.121, 1.321},  // draft
      {0.312, 1.084},  // draft, stages 2
      {0.299, 1.282},  // stages 1
      {1, 1},          // standard
      {1.17, 0.9864},  // order 3
      {1.98, 0.9812},  // best, coverage 2
      {2.62, 0.975},   // best
  }};
  return figures;
}

}  // namespace polyrecon
