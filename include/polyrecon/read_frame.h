#pragma once

#include <functional>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/frame.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// What the variance layers of the input hold.
enum class VarianceKind {
  Auto,         ///< As the renderer that uses such names defines it.
  Mean,         ///< Variance of the pixel's mean.
  Sample,       ///< Variance of one sample: divided by the sample count.
  SecondMoment  ///< Mean square m2: (m2 - mean^2) / (n - 1).
};

/// A role given by hand. layer is a layer's name (whole, or within the view layer), a single channel's whole name, or
/// the path of another image file.
struct RoleMapping {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string layer;
};

/// Reads "ROLE=LAYER". ROLE is beauty, prior, alpha, albedo, normal, depth, visibility, sample-count or motion, or a
/// companion: variance, half-a, half-b (of the beauty), albedo-variance, normal-half-a, ... Throws Error{Usage}.
RoleMapping parse_mapping(const std::string& text);

struct ReadOptions {
  std::vector<RoleMapping> map;
  std::vector<std::string> aovs;  ///< Layers for Frame::aovs: whole names, or names within the view layer.
  std::string view_layer;         ///< Empty: the first one that has a beauty.
  std::string view;               ///< Stereo view; empty: the first one.
  VarianceKind variance_kind = VarianceKind::Auto;
  double samples = 0;   ///< Samples per pixel where the file does not tell; 0: unknown.
  bool motion = false;  ///< Read the motion vectors too.
  ReadLimits limits;
  /// Called once the passes in use are known and before any pixel is read; may throw to refuse the frame.
  std::function<void(const std::string& path, const FrameShape&)> accept;
};

/// One layer in use.
struct RoleChoice {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string layer;  ///< Layer::name.
  std::string why;
};

/// Where a frame came from; what write_result and `inspect` need.
struct FrameSource {
  std::string path;
  std::vector<FileInfo> files;     ///< [0] is the file at path; further ones were mapped by hand or stand beside it.
  std::vector<Layer> layers;       ///< Of all files.
  std::string view_layer, view;    ///< Chosen ones.
  std::vector<RoleChoice> chosen;  ///< Beauty first, then its companions, the features, the others.
  std::string alpha_layer;         ///< Layer whose alpha (or only channel) is Frame::alpha; empty without one.
};

struct ReadResult {
  Frame frame;
  FrameSource source;
  std::vector<std::string> notes;  ///< One line each: what was dropped, assumed or unusual.
};

/// Reads one view layer of a render. Layers that play a role are read whole, so that a cut last chunk is noticed; NaN
/// and Inf are kept (repairing them is a stage's work). Depth and visibility have one channel: a layer of more is
/// averaged. Throws Error{Missing} where the file or a layer asked for is not there, Error{BadInput} where the file is
/// damaged, has no beauty or its layers do not fit together, Error{OutOfMemory} beyond options.limits.max_bytes.
ReadResult read_frame(const std::string& path, const ReadOptions& options = {});

/// Layers, choice of roles and notes only, without pixels; the same errors.
ReadResult read_frame_header(const std::string& path, const ReadOptions& options = {});

}  // namespace polyrecon
