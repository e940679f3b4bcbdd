// Layers of files: groups of channels, and what each is to the method.
#pragma once

#include <string>
#include <vector>

#include "polyrecon/file_info.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// Whether a layer holds the mean of a pass or accompanies the layer that does.
/// SecondMomentOfXyz: that of a colour's CIE XYZ values.
enum class Companion { Mean, VarianceOfMean, VarianceOfSample, SecondMoment, SecondMomentOfXyz, HalfA, HalfB };

/// Channels that belong together.
struct Layer {
  std::string name;                   ///< As a user types it: "ViewLayer.Combined"; unique in a file.
  std::string view_layer;             ///< "ViewLayer"; empty if names have no such prefix.
  std::string view;                   ///< Stereo view; empty without one.
  std::string pass;                   ///< "Combined"
  int file = 0;                       ///< Index into FrameSource::files.
  int part = 0;                       ///< Index into FileInfo::parts.
  std::vector<std::string> channels;  ///< Whole names, in the order R G B, X Y Z, or that of the file; without alpha.
  std::string alpha;                  ///< Whole name of the alpha channel; empty without one.
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string of;   ///< For companions: name of the layer with the mean.
  std::string why;  ///< How role and companion were found, as a phrase.
  int rank = 0;     ///< The lowest wins among layers with one role in one view layer.
};

/// The companion in words: "variance of the mean", "half A".
const char* name_of(Companion companion);

/// A view layer as one view sees it: what a frame is read of.
struct LayerView {
  std::string view_layer, view;  ///< Either is empty where names have none.
  bool operator==(const LayerView& o) const { return view_layer == o.view_layer && view == o.view; }
};

/// "view layer ViewLayer, view left"; empty where both are.
std::string name_of(const LayerView& place);

/// A layer in use.
struct RoleChoice {
  Role role = Role::Other;
  Companion companion = Companion::Mean;
  std::string layer;  ///< Layer::name.
  std::string why;    ///< How role and companion were found, as a phrase.
};

/// The source of a frame: the files, their layers, and which of them are in use.
struct FrameSource {
  std::string path;
  std::vector<FileInfo> files;      ///< [0] is the file at path; the others hold passes of the same frame.
  std::vector<Layer> layers;        ///< All layers of all files.
  std::string view_layer, view;     ///< The ones in use.
  std::vector<LayerView> pictures;  ///< All that have a beauty and that the options select, in file order.
  std::vector<RoleChoice> chosen;   ///< The layers in use: beauty, its companions, features, others.
  std::string alpha_layer;          ///< The layer that Frame::alpha is read from; empty without one.
};

}  // namespace polyrecon
