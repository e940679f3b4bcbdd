#include "pipeline/solve.h"

#include <algorithm>
#include <utility>

#include "blend/levels.h"
#include "core/rect.h"
#include "pipeline/stage.h"

namespace polyrecon {
namespace {

constexpr int smallest_level = 16;  // pixels; windows would cover most of a smaller level

/// Solves one level and, through add_coarse, the coarser ones.
Candidate solve_level(const HalfPair& pair, int level, const Params& params, std::size_t max_bytes,
                      FitCounters& counters, Progress& progress) {
  Candidate result = run_stage(pair, nullptr, params, max_bytes, counters, progress);
  const bool has_coarser = level + 1 < params.levels && std::min(pair.width(), pair.height()) >= 2 * smallest_level;
  Candidate coarse;
  if (has_coarser) {
    coarse = solve_level(downsample(pair), level + 1, params, max_bytes, counters, progress);
    result = add_coarse(pair, std::move(result), coarse, params.selection, max_bytes);
  }
  for (int stage = 2; stage <= params.stages; ++stage) {
    result = run_stage(pair, &result, params, max_bytes, counters, progress);
    if (has_coarser) result = add_coarse(pair, std::move(result), coarse, params.selection, max_bytes);
  }
  return result;
}

}  // namespace

Candidate solve(const HalfPair& pair, const Params& params, std::size_t max_bytes, FitCounters& counters,
                Progress& progress) {
  return solve_level(pair, 0, params, max_bytes, counters, progress);
}

std::size_t fit_units(const HalfPair& pair, const Params& params) {
  const std::size_t blocks = aligned_blocks(pair.variance.bounds(), block_size).size();
  const std::size_t passes =
      1 + static_cast<std::size_t>(params.stages - 1) * (params.guided_bandwidths.empty() ? 1 : 2);
  return blocks * 2 * passes * (params.stride > 1 ? 2 : 1) * 4 / 3;
}

}  // namespace polyrecon
