#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/pictures/color.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// An image of a page: a file, or a sequence of them.
struct ViewedImage {
  std::string name;  ///< For people; should differ from those of the others.
  std::string path;
  bool reference = false;  ///< Errors are relative to it. At most one is.
};

/// The scale of a map's false colours.
struct MapScale {
  double low = 0, high = 1;
  bool logarithmic = false;
};

/// Signed: blue below zero, black at zero, orange above.
enum class MapColors { Inferno, Magma, Signed };

/// A layer of an image in one frame.
struct ViewedLayer {
  std::string slot;   ///< Layers of several images with the same slot are compared with each other.
  std::string label;  ///< The slot's name for people.
  std::vector<std::string> channels;
  int x = 0, y = 0;  ///< The place of the layer's upper left pixel.
  /// Shown in false colours, on a scale that holds for all layers of the slot; otherwise the layer is a picture.
  bool is_map = false;
  std::optional<MapScale> scale = std::nullopt;
  MapColors colors = MapColors::Inferno;
  bool is_variance = false;  ///< Values are shown with their square roots.
  bool listed = false;       ///< Its values at a pixel are shown while another layer is looked at.
};

/// An HTML page in which people look at images of one or more frames: the viewer of html/viewer/, the images, and text.
/// It is a single file and needs no network. A Content-Security-Policy lets only the viewer's own script and style
/// sheet act.
class ViewerPage {
 public:
  /// title: plain text. max_bytes: of the layers, as they are packed. Throws as display_views does.
  ViewerPage(std::string title, const DisplayParams& display, std::size_t max_bytes);

  /// The names of the frames, and what they are ("frame", "round"). A page has one frame without this.
  void set_frames(const std::string& what, const std::vector<std::string>& names);

  /// Adds an image; returns its index. The image with the first layer is shown first.
  std::size_t add_image(const ViewedImage& image);

  /// Adds a layer of an image to these frames. It is stored as halves if are_halves, or if it is a picture and fits
  /// into them, else as floats. If an image has no layer of the slot that is looked at, its first layer is shown.
  /// Returns whether the layer was added: false if the page would have more than max_bytes.
  bool add_layer(std::size_t image, const std::vector<std::size_t>& frames, const ViewedLayer& layer,
                 const Image& values, bool are_halves);

  /// Plain text below the figures.
  void add_note(const std::string& text);

  /// The page. subtitle: plain text next to the title. report: HTML below the viewer; empty: none. An address such as
  /// "#a=1&pixel=[3,4]&zoom=8&x=3&y=4" in it shows something in the viewer.
  std::string html(const std::string& subtitle, const std::string& report) const;

 private:
  std::string title_;
  std::size_t max_bytes_ = 0;
  nlohmann::ordered_json scene_;
  std::string blocks_;  ///< The elements that hold packed samples.
  std::size_t block_count_ = 0;

  std::string add_block(const std::string& text);
};

}  // namespace polyrecon
