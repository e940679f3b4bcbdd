// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.134, 1.344},  // draft, order 0
      {0.138, 1.311},  // draft
      {0.36, 1.072},   // draft, stages 2
      {0.291, 1.257},  // stages 1
      {1, 1},          // standard
      {1.2, 0.9827},   // order 3
      {2.26, 0.9699},  // best, coverage 2
      {2.87, 0.9644},  // best
  }};
  return figures;
}

}  // namespace polyrecon
