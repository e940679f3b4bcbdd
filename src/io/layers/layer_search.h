#pragma once

#include <string>

#include "core/rect.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// The part of the frame's files that holds the layer.
const PartInfo& part_of(const FrameSource& source, const Layer& layer);

/// Names the part of a layer in a file of several parts: " (part 2 "right")".
std::string in_part(const FrameSource& source, const Layer& layer);

/// Whether the outer rectangle contains the inner one.
bool covers(const Rect& outer, const Rect& inner);

/// Why a part cannot be laid over another one; empty where it can. Parts of one picture may be cut to boxes of their
/// own, as renderers do that leave black margins out; a part of another picture size is no pass of the same frame.
std::string misfit(const PartInfo& part, const PartInfo& beauty);

/// Whether the layer has as many channels as the role allows.
bool is_shaped(Role role, const Layer& layer);

/// Results of find_layer without an index.
constexpr int nowhere = -1, elsewhere = -2;

/// The index of a layer by its whole name or its name within the view layer and view. A channel's name adds a layer
/// with this channel alone. A name of one view stands for the same pass of the others. elsewhere: only other pictures
/// of the file have such a layer; nowhere: none has.
int find_layer(FrameSource& source, const std::string& name);

/// Throws Error{Missing}, which lists the layers that there are.
[[noreturn]] void no_such_layer(const FrameSource& source, const std::string& name);

/// Whether a beauty has this view layer, or this view.
bool has_beauty(const FrameSource& source, std::string Layer::*place, const std::string& name);

/// The mean for a role: a layer that the user named, else one of the chosen view layer, else one of a view layer
/// without a beauty (nested layers); among these the one of lowest rank, then the first in the file. Layers without a
/// view belong to every view where no beauty is without one. Layers of parts that cannot be read are skipped.
int find_mean(const FrameSource& source, const LayerView& place, Role role, bool readable = true);

/// The same for the picture that is read.
int find_mean(const FrameSource& source, Role role, bool readable = true);

}  // namespace polyrecon
