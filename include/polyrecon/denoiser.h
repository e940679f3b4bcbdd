// Another denoiser in this process, whose picture is the prior of a reconstruction.
#pragma once

#include <cstddef>
#include <string>

#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Features as a denoiser takes them, 3 channels each; empty where the render has none.
struct DenoiserFeatures {
  Image albedo, normal;
};

/// A denoiser of single pictures. It prints nothing, and throws Error{Interrupted} when progress asks to stop. Each
/// call reports `units` units of work to the phase that the caller began, and takes at most max_bytes in addition to
/// its arguments and its result, unless it cannot work with so little.
class Denoiser {
 public:
  static constexpr std::size_t units = 100;

  virtual ~Denoiser() = default;

  /// Name, version and device, for the report: "Open Image Denoise 2.5.1 (cpu)".
  virtual std::string name() const = 0;

  /// The file that it was loaded from; empty if it is part of this program.
  virtual std::string place() const { return {}; }

  /// Removes the noise of the features. A denoiser that takes noisy ones returns them as they are.
  virtual DenoiserFeatures prefilter(DenoiserFeatures noisy, std::size_t max_bytes, Progress& progress) const = 0;

  /// Denoises a picture of 3 channels, linear radiance, all values finite. features: prefiltered, of the picture's
  /// size.
  virtual Image denoise(const Image& noisy, const DenoiserFeatures& features, std::size_t max_bytes,
                        Progress& progress) const = 0;
};

}  // namespace polyrecon
