// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.173, 1.359},  // draft, order 0
      {0.162, 1.311},  // draft
      {0.412, 1.108},  // draft, stages 2
      {0.332, 1.18},   // stages 1
      {1, 1},          // standard
      {1.83, 1.005},   // stages 3
      {3.56, 0.9219},  // best, stages 2
      {5.88, 0.9238},  // best
  }};
  return figures;
}

}  // namespace polyrecon
