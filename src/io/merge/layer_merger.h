#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "io/exr/bands.h"
#include "io/merge/counts.h"
#include "io/merge/sums.h"
#include "io/merge/task.h"

namespace polyrecon {

/// Merges the layers of a task band by band: adds up the samples of all renders, and writes mean, variance and halves.
class LayerMerger {
 public:
  /// The task must outlive the merger.
  explicit LayerMerger(const MergeTask& task)
      : task_(task), overflows_(task.first().layers.size()), lone_overflows_(task.first().layers.size()) {}

  /// Fills the merged channels of a band of the result.
  void merge(const Weights& weights, NativeBand& band);

  /// Notes what was unusual in the bands so far.
  void note(MergeResult& report) const;

  /// Bytes that a pixel of one merged channel needs: its sums, its samples in the result, and those of the renders that
  /// are decoded at once.
  static std::size_t bytes_per_pixel();

 private:
  /// The samples of a band of one render.
  struct DecodedRender {
    std::vector<std::vector<float>> samples;  ///< By part.
    std::vector<const float*> planes;         ///< By slot.
  };
  struct Moments {
    double mean;
    double variance;  ///< Variance of that mean.
  };

  /// Decodes the merged channels of one render, each part once.
  DecodedRender decode(std::size_t k, const NativeBand& band);
  /// Makes +Inf of a channel that stands alone NaN, as drop_lone_overflows does. Returns the number of these samples.
  static std::size_t drop_fireflies(const Render& render, const Layer& layer, const std::string& channel,
                                    const NativeBand& band, float* plane);
  /// Adds the renders with indices from first to end - 1 to the sums. Each sum is in the order of the renders.
  void add_renders(std::size_t first, std::size_t end, const Weights& weights, const NativeBand& band,
                   std::vector<ChannelSums>& sums);
  void add(ChannelSums& sums, std::size_t i, float x, double weight, std::size_t k);
  /// The weighted mean of layer l over all renders, or with MergeOptions::half_b the plain mean of the halves. Where no
  /// render has samples, between regions and outside of the parts of a feature, it is 0.
  Moments moments(std::size_t l, const ChannelSums& sums, std::size_t i, const NativeBand& band) const;
  void write_mean(std::size_t l, NativeChannel& channel, const ChannelSums& sums, const NativeBand& band) const;
  void write_channel(std::size_t l, const std::string& name, const ChannelSums& sums, NativeBand& band);

  const MergeTask& task_;
  std::atomic<std::size_t> left_out_ = 0;            ///< Samples that are not finite.
  std::vector<std::atomic<std::size_t>> overflows_;  ///< Half samples of +Inf that count as the largest half, by layer.
  std::vector<std::atomic<std::size_t>> lone_overflows_;  ///< Those that are left out, by layer.
  std::atomic<bool> any_spread_ = false;                  ///< The renders differ somewhere.
};

}  // namespace polyrecon
