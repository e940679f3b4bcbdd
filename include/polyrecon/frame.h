#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// A pass of a Monte Carlo render: per-pixel means, and what is known of their noise.
struct Pass {
  std::string name;  ///< Layer name as in the file, without a channel: "ViewLayer.Combined".
  Image mean;        ///< 1 or 3 channels.
  Image variance;    ///< Variance of the mean, same shape; empty where unknown.
  Image half_a;      ///< Means over two independent halves of the samples; both there or both empty.
  Image half_b;
  bool variance_is_estimated = false;  ///< From the mean (noise/variance.h), not told by the file.

  bool has_halves() const { return !half_a.empty(); }
  bool noise_is_told() const { return !variance.empty() || has_halves(); }
};

enum class FeatureKind { Normal, Albedo, Depth, Visibility };

/// A feature f of the local model (2): normal and albedo have 3 channels, depth and visibility 1.
struct Feature {
  FeatureKind kind = FeatureKind::Normal;
  Pass pass;
};

/// One view layer of one frame, as the reconstruction sees it: linear radiance, pixel (0, 0) at the upper left corner
/// of the data window. All images have the same width and height.
struct Frame {
  Rect data_window;               ///< Where the pixels stand in the file's coordinates.
  Pass beauty;                    ///< y of equation (1), 3 channels.
  std::vector<Feature> features;  ///< f of equation (2).
  std::vector<Pass> aovs;         ///< Further colour layers to be reconstructed with the beauty's windows, 3 channels.
  Pass prior;                     ///< An already denoised beauty; prior.mean is empty where there is none.
  Image alpha;                    ///< 1 channel; empty where there is none.
  Image sample_count;             ///< Samples per pixel, 1 channel; empty where unknown.
  Image motion;                   ///< 4 channels: columns and rows from a pixel to its point's place in the frame
                                  ///< before (0, 1) and in the one after (2, 3); empty where unknown.

  int width() const { return beauty.mean.width(); }
  int height() const { return beauty.mean.height(); }
};

/// The size of a frame as memory sees it, known before any pixel is read.
struct FrameShape {
  std::size_t pixels = 0;
  int channels = 0;          ///< Of all passes in use with their variances (told or estimated) and halves.
  int color_channels = 3;    ///< Of the beauty and the AOVs.
  int feature_channels = 0;  ///< Of the features' means.
  int prior_channels = 0;    ///< Of the prior, which waits beside the fits for its turn.
  int beside = 0;            ///< Held beside it all along: neighbours in time, the next frame of a sequence.
};

}  // namespace polyrecon
