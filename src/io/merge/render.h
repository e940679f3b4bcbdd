#pragma once

#include <string>
#include <vector>

#include "io/merge/regions.h"
#include "polyrecon/file_info.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// One render. Its layers are in the order of the first render's.
struct Render {
  std::vector<FileInfo> files;  ///< [0] is the named one; the others hold its other passes.
  std::vector<Layer> layers;
  std::vector<bool> absent;  ///< For each layer whether only the first render has it; empty for the first render.
  Rect window;               ///< The data windows of all parts together.
  Region region;             ///< The pixels it has samples for.
};

const std::string& path_of(const Render& render);
const FileInfo& file_of(const Render& render, const Layer& layer);
const PartInfo& part_of(const Render& render, const Layer& layer);

/// Throws Error{BadInput}: the render does not fit the first one.
[[noreturn]] void misfit(const Render& render, const Render& first, const std::string& what);

/// The treatment of a layer.
enum class Fate { Merged, Kept, Dropped };

/// The treatment of a layer that all renders have.
Fate fate_of(const Render& first, const Layer& layer);

/// The channels of a layer, its alpha last.
std::vector<std::string> all_channels(const Layer& layer);

}  // namespace polyrecon
