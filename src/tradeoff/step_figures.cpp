// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.155, 1.296},  // draft, order 0
      {0.142, 1.258},  // draft
      {0.329, 1.064},  // draft, stages 2
      {0.325, 1.223},  // stages 1
      {1, 1},          // standard
      {1.29, 0.9898},  // order 3
      {2.16, 0.9798},  // best, coverage 2
      {2.58, 0.9772},  // best
  }};
  return figures;
}

}  // namespace polyrecon
