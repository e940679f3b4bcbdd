#pragma once

#include "polyrecon/layers.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

inline LayerView place_of(const Layer& layer) { return {layer.view_layer, layer.view}; }
inline LayerView place_of(const FrameSource& source) { return {source.view_layer, source.view}; }

/// Whether the source has more pictures than the one in use, and this place is that of another one.
bool is_of_another_picture(const FrameSource& source, const LayerView& place);

/// Sets FrameSource::pictures, and view_layer and view to the one that is read. A layer that the user maps to the
/// beauty decides: its view layer and view are then the only ones. Throws Error{Missing} where the file has no such
/// view layer or view.
void choose_picture(FrameSource& source, const ReadOptions& options);

}  // namespace polyrecon
