// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.136, 1.359},  // draft, order 0
      {0.152, 1.311},  // draft
      {0.344, 1.108},  // draft, stages 2
      {0.349, 1.18},   // stages 1
      {1, 1},          // standard
      {1.7, 1.005},    // stages 3
      {3.76, 0.9219},  // best, stages 2
      {5.96, 0.9238},  // best
  }};
  return figures;
}

}  // namespace polyrecon
