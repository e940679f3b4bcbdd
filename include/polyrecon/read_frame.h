// Reads one view layer of a render from a file: finds the layers, chooses what each is to the method, decodes them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/frame.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// What the variance layers of the input hold. Frames have the variance of the mean of a pixel's n samples.
enum class VarianceKind {
  Auto,         ///< Depends on the renderer, which is recognised by the layer's name.
  Mean,         ///< Variance of the mean.
  Sample,       ///< Variance of one sample v; the variance of the mean is v / n.
  SecondMoment  ///< Mean of the squared samples m2; the variance of the mean is (m2 - mean^2) / (n - 1).
};

/// A layer whose role the user gives.
struct RoleMapping {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string
      layer;  ///< Name of a layer (whole, or within the view layer), whole name of a channel, or path of a file.
};

/// Parses "ROLE=LAYER". ROLE is beauty, prior, alpha, albedo, normal, depth, visibility, sample-count or motion, or a
/// companion: variance, half-a, half-b (of the beauty), albedo-variance, normal-half-a, ... Throws Error{Usage}.
RoleMapping parse_mapping(const std::string& text);

/// What is read of a file, and how.
struct ReadOptions {
  std::vector<RoleMapping> map;   ///< Roles that the user gives; all others are found by name.
  std::vector<std::string> aovs;  ///< Layers for Frame::aovs: whole names, or names within the view layer.
  std::string view_layer;         ///< Empty: the first one that has a beauty.
  std::string view;               ///< Stereo view; empty: the first one.
  VarianceKind variance_kind = VarianceKind::Auto;
  double samples = 0;   ///< Samples per pixel of a file that does not say; 0: unknown.
  bool motion = false;  ///< Whether to read the motion vectors.
  ReadLimits limits;
  /// Called when the passes in use are known and before any pixel is read. It may throw to refuse the frame.
  std::function<void(const std::string& path, const FrameShape&)> accept;
};

/// A layer in use.
struct RoleChoice {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string layer;  ///< Layer::name.
  std::string why;    ///< How role and companion were found, as a phrase.
};

/// Where a frame came from: the files, their layers, and which of them are in use.
struct FrameSource {
  std::string path;
  std::vector<FileInfo> files;     ///< [0] is the file at path; the others hold passes of the same frame.
  std::vector<Layer> layers;       ///< All layers of all files.
  std::string view_layer, view;    ///< The ones in use.
  std::vector<RoleChoice> chosen;  ///< The layers in use: beauty, its companions, features, others.
  std::string alpha_layer;         ///< The layer that Frame::alpha is read from; empty without one.
};

/// A frame that was read.
struct ReadResult {
  Frame frame;
  FrameSource source;
  std::vector<std::string> notes;  ///< Messages of one line: what was dropped, assumed or unusual.
};

/// Reads one view layer of a render. Layers in use are read completely, so that a missing last chunk is noticed. NaN
/// and infinity are kept; reconstruct repairs them. A depth or visibility layer of several channels is averaged to one.
/// Throws Error{Missing} if the file or a requested layer is missing, Error{BadInput} if the file is damaged, has no
/// beauty, or its layers do not fit together, Error{OutOfMemory} if the pixels need more than options.limits.max_bytes.
ReadResult read_frame(const std::string& path, const ReadOptions& options = {});

/// The same without pixels: source and notes, with the frame empty. Throws as read_frame does.
ReadResult read_frame_header(const std::string& path, const ReadOptions& options = {});

}  // namespace polyrecon
