#include "io/values/accept_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/halves.h"
#include "core/repair.h"
#include "io/values/pass_values.h"

namespace polyrecon {
namespace {

bool has_finite_sample(const Image& image) {
  for (int c = 0; c < image.channels(); ++c)
    if (std::any_of(image.plane(c), image.plane(c) + image.pixels(), [](Real v) { return std::isfinite(v); }))
      return true;
  return false;
}

/// The number of samples of a channel that are not finite where those of the mean are usable. Pixels in which nothing
/// was rendered do not count.
std::size_t samples_lacking(const Image& companion, const Image& mean, int c) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < mean.pixels(); ++i) {
    const Real m = mean.plane(c)[i];
    count += usable(m) && m != 0 && !std::isfinite(companion.plane(c)[i]);
  }
  return count;
}

std::size_t samples_lacking(const Image& companion, const Image& mean) {
  std::size_t count = 0;
  for (int c = 0; c < mean.channels(); ++c) count += samples_lacking(companion, mean, c);
  return count;
}

}  // namespace

std::string check_variance(Image& variance, const Image& mean, const PassNames& names) {
  if (variance.empty()) return {};
  if (!has_finite_sample(variance)) {
    variance = {};
    return fmt::format("{} is not used: it has no finite value", names.variance);
  }
  const std::size_t lacking = samples_lacking(variance, mean);
  if (lacking == 0) return {};
  for (int c = 0; c < mean.channels(); ++c)
    if (2 * samples_lacking(variance, mean, c) > mean.pixels()) {
      variance = {};
      return fmt::format("{} is not used: {} of its samples are not finite where {} is", names.variance, lacking,
                         names.mean);
    }
  return fmt::format(
      "{}: {} samples are not finite where {} is; their pixels take the noise of the surroundings, but stay as they "
      "are where that is more than {} pixels away",
      names.variance, lacking, names.mean, repair_depth);
}

std::string note_on_large_variance(const Pass& beauty, const PassNames& names, const std::string& advice) {
  const double excess = variance_excess(beauty.mean, beauty.variance);
  if (excess <= most_variance_excess) return {};
  return fmt::format(
      "{} is {:.0f} times as large as the differences of neighbouring pixels allow, so too much is smoothed; {}",
      names.variance, excess, advice);
}

std::string check_halves(Pass& pass, const PassNames& names, const std::string& advice) {
  if (!pass.has_halves() || !contradict(pass.mean, pass.half_a, pass.half_b)) return {};
  const std::size_t unusable = samples_lacking(pass.half_a, pass.mean) + samples_lacking(pass.half_b, pass.mean);
  pass.half_a = pass.half_b = {};
  if (unusable > 0)
    return fmt::format(
        "{} and {} are not used: {} of their samples are not finite where {} is, and they contradict it; render the "
        "halves again",
        names.half_a, names.half_b, unusable, names.mean);
  return fmt::format("{} and {} are not used: they contradict {}, which is not their mean; {}", names.half_a,
                     names.half_b, names.mean, advice);
}

}  // namespace polyrecon
