#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/common/comparison.h"
#include "html/viewer_page.h"
#include "io/pictures/color.h"
#include "metrics/reliability.h"
#include "metrics/worst_pixels.h"

namespace polyrecon {

/// The page of compare: the viewer with all images, the reference, and FLIP and relative error of each pixel; below it
/// the figures, the worst pixels, how reliable error maps are, and for sequences figures over time. Images are packed
/// as they come, so only one frame has to be in memory.
class ComparisonPage {
 public:
  /// images: paths, the reference the last one. frames: numbers; empty where no sequence is compared. one_reference:
  /// whether all frames have the same one. max_bytes: of the pictures in the page.
  ComparisonPage(const std::vector<std::string>& images, const std::vector<int>& frames, bool one_reference,
                 const DisplayParams& display, std::size_t max_bytes);

  /// Adds an image's comparisons in a frame, which must have their images. frame: index. estimated: its error map
  /// (relative squared error, 1 channel); empty without one.
  void add(std::size_t image, std::size_t frame, const std::vector<Comparison>& comparisons, const Image& estimated);

  /// comparisons: all that were added, by image.
  std::string html(const std::vector<std::vector<Comparison>>& comparisons);

 private:
  struct Worst {
    std::size_t image = 0, frame = 0;
    int x = 0, y = 0;
    double value = 0;
  };
  struct Reliability {
    std::size_t image = 0, frame = 0;
    std::vector<ReliabilityDecile> deciles;
  };

  std::vector<std::string> names_;  ///< The images' names, the reference the last one.
  std::vector<int> frames_;
  ViewerPage page_;
  std::vector<Worst> worst_;
  std::vector<Reliability> reliability_;
  bool one_reference_;
  std::vector<std::vector<std::string>> reference_layers_;  ///< Those added so far, by frame.
  std::size_t left_out_ = 0;

  std::size_t reference() const { return names_.size() - 1; }
  void put(std::size_t image, const std::vector<std::size_t>& frames, const ViewedLayer& layer, const Image& values);
  void add_reference(std::size_t frame, const ViewedLayer& layer, const Image& values);
  std::string figures(const std::vector<std::vector<Comparison>>& comparisons, const std::string& layer) const;
  std::string over_time(const std::vector<std::vector<Comparison>>& comparisons) const;
  std::string worst_section() const;
  std::string reliability_section() const;
  std::string link(std::size_t image, std::size_t frame, const std::string& more) const;
};

}  // namespace polyrecon
