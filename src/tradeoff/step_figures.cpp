// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.115, 1.302},  // draft, order 0
      {0.132, 1.27},   // draft
      {0.292, 1.078},  // draft, stages 2
      {0.298, 1.229},  // stages 1
      {1, 1},          // standard
      {1.22, 0.9909},  // order 3
      {1.86, 0.9823},  // best, coverage 2
      {2.5, 0.9815},   // best
  }};
  return figures;
}

}  // namespace polyrecon
