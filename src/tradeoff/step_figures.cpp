// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.141, 1.297},  // draft, order 0
      {0.138, 1.265},  // draft
      {0.355, 1.067},  // draft, stages 2
      {0.314, 1.226},  // stages 1
      {1, 1},          // standard
      {1.11, 0.9894},  // order 3
      {1.74, 0.9805},  // best, coverage 2
      {2.1, 0.9795},   // best
  }};
  return figures;
}

}  // namespace polyrecon
