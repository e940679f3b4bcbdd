#pragma once

#include <string>
#include <vector>

#include "polyrecon/file_info.h"

namespace polyrecon {

struct MergeOptions {
  /// Samples of each render, where metadata would mislead: Blender 5 writes the count of the whole sequence into every
  /// subset of it. 0: as the files say.
  double samples = 0;
  /// Renders of half B; the others are half A then, in place of even and odd index.
  std::vector<std::string> half_b;
  bool compress = true;  ///< ZIP, or none: larger, several times as fast to write and to read.
  ReadLimits limits;
};

struct MergeResult {
  int files = 0;
  double samples = 0;  ///< Samples per pixel of the result, mean over the frame; 0 where the files do not tell.
  std::vector<std::string> merged;  ///< Layers with mean, variance and halves.
  std::vector<std::string> kept;    ///< Layers taken from the first file.
  std::vector<std::string>
      dropped;  ///< Layers that say nothing of the whole: companions and sample counts of the inputs.
  std::vector<std::string> notes;
};

/// Joins K independent renders x_k of one frame (subsets of one sequence, or different seeds) with n_k samples each. Of
/// every noisy layer, per pixel and channel:
///     mean        m = sum n_k x_k / sum n_k
///     ` Variance` of m: sum n_k^2 (x_k - m)^2 / ((sum n_k)^2 - sum n_k^2), NaN where only one render has samples
///     ` A`, ` B`  the same mean over the renders with even and odd index, m where a half has no samples
/// With options.half_b the picture is the plain mean of its halves, (A + B) / 2, whatever their counts, and its
/// variance s^2 (1 / n_A + 1 / n_B) / 4, s^2 being that of one sample: the variance above times sum n_k. This is the
/// merge of adaptive renders where the values of each half chose the counts of the other: no weight depends on the
/// values it multiplies, so m is unbiased. n_k comes from a sample-count pass, else from metadata or options, else all
/// renders count alike. Samples that are not finite are left out and counted in a note. The sum of n_k is kept in
/// `<view layer>.Sample Count.X`, other layers come from the first file, bit for bit, as do further ones that only it
/// has. Writes one part of scanlines, merged layers as float; memory is bounded by one band of lines,
/// Error{OutOfMemory} where that needs more than options.limits.max_bytes. Throws Error{Usage} for fewer than two files
/// or one given twice, Error{BadInput} naming the first file that does not fit the first one, Error{Missing}, and what
/// write_atomically throws.
MergeResult merge(const std::vector<std::string>& paths, const std::string& target, const MergeOptions& options = {});

}  // namespace polyrecon
