// PROVISIONAL: rough guesses until tests/bench/accuracy.py has been run, which writes these from the samples (geometric
// means over them, in the order of ladder()).
#include "tradeoff/plan.h"

namespace polyrecon {

const std::array<StepFigures, step_count>& measured_steps() {
  static const std::array<StepFigures, step_count> figures{{
      {0.15, 1.5},  // draft, order 0
      {0.2, 1.4},   // draft
      {0.35, 1.2},  // draft, stages 2
      {0.4, 1.1},   // stages 1
      {1, 1},       // standard
      {1.5, 0.98},  // stages 3
      {2.5, 0.95},  // best, stages 2
      {4, 0.93},    // best
  }};
  return figures;
}

}  // namespace polyrecon
