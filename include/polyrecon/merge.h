// Joins independent renders of one frame into one file with variance and halves: `polyrecon merge`.
#pragma once

#include <string>
#include <vector>

#include "polyrecon/encoding.h"
#include "polyrecon/file_info.h"

namespace polyrecon {

/// How renders are merged.
struct MergeOptions {
  /// Samples per pixel of each render; 0: as the files say. Needed where their metadata misleads: Blender 5 writes the
  /// count of the whole sequence into every subset of it.
  double samples = 0;
  /// Renders of half B; all others are half A. Empty: renders are half A and B in turn, or,
  /// where that gives one half more than 1.25 times the samples of the other, divided as evenly as they allow.
  std::vector<std::string> half_b;
  Encoding encoding = {};  ///< Without a compression: ZIP. With Compression::None the file is larger, and faster to
                           ///< write and to read. A lossy one is for joined regions alone, as noise keeps its bits.
  ReadLimits limits;
};

/// The layers that a merge wrote, by name.
struct MergeResult {
  int files = 0;                     ///< Renders merged.
  double samples = 0;                ///< Mean samples per pixel of the result; 0 if unknown.
  std::vector<std::string> merged;   ///< Written with mean, variance and halves, or as joined regions.
  bool joined = false;               ///< Regions of one render each were put side by side, without new variance.
  std::vector<std::string> kept;     ///< Copied from the first file.
  std::vector<std::string> dropped;  ///< Left out, as they describe one input only: its companions and sample count.
  std::vector<std::string> notes;    ///< Messages of one line: what was assumed or unusual.
};

/// Joins K independent renders x_k of one frame (subsets of one sample sequence, or different seeds) with n_k samples
/// each, and writes target. For every noisy layer, per pixel and channel:
///     mean        m = sum n_k x_k / sum n_k
///     ` Variance` variance of m: sum n_k^2 (x_k - m)^2 / ((sum n_k)^2 - sum n_k^2); NaN if only one render has samples
///     ` A`, ` B`  the mean over the renders of a half; m if the half has no samples
/// With options.half_b the mean is (A + B) / 2 whatever the halves' counts n_A and n_B, and its variance is
/// s^2 (1 / n_A + 1 / n_B) / 4, where s^2, the variance of one sample, is the variance above times sum n_k. This is the
/// merge for adaptive renders in which the values of each half choose the counts of the other: no weight depends on the
/// values it multiplies, so m is unbiased.
///
/// n_k comes from a sample-count pass, else from options or metadata, else all renders have the same weight. Samples
/// that are not finite are left out and counted in a note. The sum of n_k is written as `<view layer>.Sample Count.X`.
/// Layers without noise, and layers that only the first file has, are copied from the first file bit for bit.
///
/// Data windows may differ. Renders whose windows have at least half of the smaller one in common show the same region
/// of the frame. Beyond its window a render saw black, which counts as samples of 0. If the other renders are not black
/// there, the render has no samples beyond its window. All other renders are regions of the frame: each has samples in
/// its region only, and the result covers all regions, with 0 in between. For a render that is black outside a region,
/// the box of its other pixels takes the place of its window. If some region, or more than 5 % of the picture, has one
/// render only, no variance or halves are made; those of the files are kept where all have them.
///
/// The result has one part of scanlines. Its means, variances and halves are floats; regions that are joined keep the
/// first file's types. It is read back before it takes its name.
/// Memory is bounded by one band of lines. Throws Error{Usage} for fewer than two files or a file given twice,
/// Error{Missing} for a missing file, Error{BadInput} naming the first file that does not fit the first one,
/// Error{OutOfMemory} if a band needs more than options.limits.max_bytes, and Error{CannotWrite}; an older target then
/// stays as it was.
MergeResult merge(const std::vector<std::string>& paths, const std::string& target, const MergeOptions& options = {});

}  // namespace polyrecon
