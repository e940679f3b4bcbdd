// Options of reading a file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/frame.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// The kind of the input's variance layers. Frames have the variance of the mean of a pixel's n samples.
enum class VarianceKind {
  Auto,         ///< Depends on the renderer, which is recognised by the layer's name.
  Mean,         ///< Variance of the mean.
  Sample,       ///< Variance of one sample v; the variance of the mean is v / n.
  SecondMoment  ///< Mean of the squared samples m2; the variance of the mean is (m2 - mean^2) / (n - 1).
};

/// Whether the columns of the picture go on around it.
enum class Wrap {
  Auto,  ///< If the file says that it is a panorama: OpenEXR's attribute envmap is latlong.
  None,
  X  ///< The last column is next to the first.
};

/// A layer whose role the user gives.
struct RoleMapping {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string
      layer;         ///< Name of a layer (whole, or within the view layer), whole name of a channel, or path of a file.
  std::string file;  ///< Path of the file where no layer has that name, for a frame of a sequence; empty: `layer`.
};

/// Parses "ROLE=LAYER". ROLE is the name of a role that one layer is chosen for (roles.h), or a companion: variance,
/// half-a, half-b (of the beauty), albedo-variance, normal-half-a, ... Throws Error{Usage}.
RoleMapping parse_mapping(const std::string& text);

/// Options of reading a file.
struct ReadOptions {
  std::vector<RoleMapping> map;   ///< Roles that the user gives; all others are found by name.
  std::vector<std::string> aovs;  ///< Layers for Frame::aovs: whole names, or names within the view layer.
  std::string view_layer;         ///< Selects the view layer; empty: all that have a beauty.
  std::string view;               ///< Selects the stereo view; empty: all that have a beauty.
  /// The one of the selected (FrameSource::pictures) that is read; nothing: the first.
  std::optional<LayerView> picture;
  /// A layer to read in place of the beauty, with the features of its view layer and without a prior; empty: none.
  std::string own_windows;
  VarianceKind variance_kind = VarianceKind::Auto;
  Wrap wrap = Wrap::Auto;
  double samples = 0;   ///< Samples per pixel of a file that does not say; 0: unknown.
  bool motion = false;  ///< Whether to read the motion vectors.
  ReadLimits limits;
  /// Called when the passes in use are known and before any pixel is read. It may throw to refuse the frame.
  std::function<void(const std::string& path, const FrameShape&)> accept;
};

}  // namespace polyrecon
