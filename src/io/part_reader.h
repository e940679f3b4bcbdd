#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/observed_read.h"
#include "polyrecon/image.h"
#include "polyrecon/layers.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// Collects the images that are wanted, then decodes every part once. All images cover the frame's window; where a
/// part's data window does not, its pixels are 0, as OpenEXR defines it.
class PartReader {
 public:
  PartReader(const FrameSource& source, const ReadLimits& limits) : source_(source), limits_(limits) {}

  /// Sets the frame's window, before any image is wanted.
  void cover(const Rect& window) { window_ = window; }

  /// Wants channels of a layer's part. The pointer stays valid; read() fills the image. Throws Error{OutOfMemory} where
  /// all images together need more than the limit.
  Image* want(const Layer& layer, const std::vector<std::string>& channels);

  std::size_t samples() const { return samples_; }  ///< In all images wanted so far.

  /// Decodes every part with a wanted image once. observer: sees each band, with the other channels of the part too.
  void read(const BandObserver& observer);

  const PartInfo& part_of(const Layer& layer) const {
    return source_.files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)];
  }

  Rect window_of(const Layer& layer) const { return part_of(layer).data_window; }

 private:
  struct Wanted {
    std::vector<std::string> channels;
    std::unique_ptr<Image> image;
  };
  const FrameSource& source_;
  const ReadLimits& limits_;
  Rect window_;
  std::size_t samples_ = 0;
  std::map<std::pair<int, int>, std::vector<Wanted>> parts_;
};

}  // namespace polyrecon
