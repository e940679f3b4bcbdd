// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.129, 1.36},   // draft, order 0
      {0.13, 1.327},   // draft
      {0.344, 1.085},  // draft, stages 2
      {0.299, 1.284},  // stages 1
      {1, 1},          // standard
      {1.2, 0.9858},   // order 3
      {2.03, 0.9815},  // best, coverage 2
      {2.64, 0.976},   // best
  }};
  return figures;
}

}  // namespace polyrecon
