// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.121, 1.344},  // draft, order 0
      {0.156, 1.307},  // draft
      {0.339, 1.08},   // draft, stages 2
      {0.291, 1.246},  // stages 1
      {1, 1},          // standard
      {1.66, 1.004},   // stages 3
      {2.7, 0.9909},   // best, stages 2
      {4.69, 0.9982},  // best
  }};
  return figures;
}

}  // namespace polyrecon
