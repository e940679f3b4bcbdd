#include "io/merge/place_renders.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rect.h"
#include "io/files/file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The data windows of all parts together.
Rect window_of(const Render& render) {
  Rect window;
  for (const FileInfo& file : render.files)
    for (const PartInfo& part : file.parts)
      if (part.readable()) window = bounding(window, part.data_window);
  return window;
}

/// The first beauty that can be read.
const Layer& beauty_of(const Render& render) {
  std::string obstacle;
  for (const Layer& layer : render.layers) {
    if (layer.role != Role::Beauty || layer.companion != Companion::Mean) continue;
    if (part_of(render, layer).readable()) return layer;
    const FileInfo& file = file_of(render, layer);
    obstacle = fmt::format("{}is {}", file.parts.size() == 1 ? "" : fmt::format("({}) ", title_of(file, layer.part)),
                           part_of(render, layer).obstacle());
  }
  if (!obstacle.empty()) throw Error(ExitCode::BadInput, fmt::format("{}: the beauty {}", path_of(render), obstacle));
  throw Error(ExitCode::Missing, fmt::format("{}: no beauty to merge", path_of(render)));
}

void require_size(const std::vector<Render>& renders, std::size_t max_pixels) {
  Rect all;
  for (const Render& render : renders) all = bounding(all, render.window);
  const double width = static_cast<double>(all.x1) - all.x0, height = static_cast<double>(all.y1) - all.y0;
  if (width * height > static_cast<double>(max_pixels))
    throw Error(ExitCode::BadInput, fmt::format("{}: the renders together cover {:.0f} x {:.0f} pixels, more than the "
                                                "limit of {}; are they of one frame?",
                                                path_of(renders.front()), width, height, max_pixels));
}

}  // namespace

void place_renders(std::vector<Render>& renders, std::size_t max_pixels) {
  for (Render& render : renders) render.window = window_of(render);
  require_size(renders, max_pixels);
  std::vector<ShownPart> shown;
  for (const Render& render : renders) {
    const Layer& beauty = beauty_of(render);
    shown.push_back({render.window, &file_of(render, beauty), beauty.part, all_channels(beauty)});
  }
  const std::vector<Region> regions = find_regions(shown);
  for (std::size_t k = 0; k < renders.size(); ++k) renders[k].region = regions[k];
}

}  // namespace polyrecon
