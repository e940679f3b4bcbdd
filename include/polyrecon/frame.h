// A frame in memory: the passes of one view layer, as read_frame fills them and reconstruct takes them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// A pass of a Monte Carlo render: the mean of each pixel's samples, and what is known of the noise of that mean.
struct Pass {
  std::string name;      ///< Name of the layer in the file, without a channel: "ViewLayer.Combined".
  Image mean;            ///< 1 or 3 channels.
  Image variance;        ///< Variance of the mean, same shape; empty if unknown.
  Image half_a, half_b;  ///< Means over two independent halves of the samples, same shape; both empty if unknown.
  bool variance_is_estimated = false;  ///< The variance was estimated from the mean: the file has none.

  bool has_halves() const { return !half_a.empty(); }
  bool noise_is_known() const { return !variance.empty() || has_halves(); }
};

/// A pass that guides the reconstruction: f of equation (2). Its role is a feature, which says how many channels it
/// has.
struct Feature {
  Role role = Role::Normal;
  Pass pass;
};

/// One view layer of one frame. All images have the same width and height; pixel (0, 0) is the upper left corner of the
/// data window. Colours are linear radiance.
struct Frame {
  Rect data_window;               ///< The frame's pixels in the coordinates of the file.
  Pass beauty;                    ///< y of equation (1), 3 channels.
  std::vector<Feature> features;  ///< f of equation (2).
  std::vector<Pass> aovs;         ///< Further colour layers, reconstructed with the beauty's windows; 3 channels.
  Pass prior;                     ///< A denoised beauty from elsewhere, 3 channels; prior.mean is empty if unknown.
  Image alpha;                    ///< 1 channel; empty if the render has none.
  Image sample_count;             ///< Samples per pixel, 1 channel; empty if unknown.
  bool wraps = false;             ///< A panorama: the last column is next to the first.
  double sky_depth = 1e9;         ///< Depths from here on mean that rays hit nothing.
  Image motion;                   ///< Pixels from a point's place in this frame to its place in the frame before
                                  ///< (channel 0: columns, 1: rows) and after (2: columns, 3: rows); empty if unknown.

  int width() const { return beauty.mean.width(); }
  int height() const { return beauty.mean.height(); }
};

/// The size of a frame, known before any pixel is read; memory needs are estimated from it.
struct FrameShape {
  std::size_t pixels = 0;
  int channels = 0;          ///< All passes in use, with their halves and variances, those to be estimated included.
  int color_channels = 3;    ///< Beauty and AOVs.
  int feature_channels = 0;  ///< Means of the features.
  int prior_channels = 0;    ///< The prior, with halves and variance; it stays in memory during the fits.
  bool prior_has_halves = false;
  bool runs_denoiser = false;  ///< The prior is made by a denoiser in this process.
  int wrapped_rows = 0;        ///< Rows of a frame that wraps, else 0: columns are repeated beyond both ends.
  int other_channels = 0;      ///< Other frames in memory at the same time: neighbours in time, the next of a sequence.
};

}  // namespace polyrecon
