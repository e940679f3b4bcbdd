// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.13, 1.314},   // draft, order 0
      {0.135, 1.289},  // draft
      {0.328, 1.098},  // draft, stages 2
      {0.265, 1.207},  // stages 1
      {1, 1},          // standard
      {1.53, 1.001},   // stages 3
      {2.87, 0.9616},  // best, stages 2
      {4.74, 0.9644},  // best
  }};
  return figures;
}

}  // namespace polyrecon
