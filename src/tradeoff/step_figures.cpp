// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.159, 1.338},  // draft, order 0
      {0.149, 1.3},    // draft
      {0.409, 1.071},  // draft, stages 2
      {0.296, 1.24},   // stages 1
      {1, 1},          // standard
      {1.87, 0.9953},  // stages 3
      {3.13, 0.9882},  // best, stages 2
      {4.85, 0.9955},  // best
  }};
  return figures;
}

}  // namespace polyrecon
