// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.121, 1.299},  // draft, order 0
      {0.135, 1.267},  // draft
      {0.313, 1.069},  // draft, stages 2
      {0.31, 1.227},   // stages 1
      {1, 1},          // standard
      {1.1, 0.9899},   // order 3
      {1.95, 0.9819},  // best, coverage 2
      {2.26, 0.9813},  // best
  }};
  return figures;
}

}  // namespace polyrecon
