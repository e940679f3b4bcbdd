// Made by tests/bench/accuracy.py from the samples; geometric means over them, in the order of ladder().
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.161, 1.299},  // draft, order 0
      {0.157, 1.267},  // draft
      {0.344, 1.069},  // draft, stages 2
      {0.35, 1.227},   // stages 1
      {1, 1},          // standard
      {1.17, 0.9899},  // order 3
      {1.8, 0.9819},   // best, coverage 2
      {2.24, 0.9812},  // best
  }};
  return figures;
}

}  // namespace polyrecon
