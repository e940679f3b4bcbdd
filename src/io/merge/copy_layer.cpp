#include "io/merge/copy_layer.h"

#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/rect.h"
#include "io/merge/area.h"
#include "io/merge/output.h"

namespace polyrecon {
namespace {

/// Whether all that a render shows is shown by the first one of its group.
bool is_behind(const MergeTask& task, std::size_t k) {
  const Region& region = task.renders[k].region;
  return region.rank > 0 && intersect(task.renders[region.group].region.rect, region.rect) == region.rect;
}

void copy_layer(const MergeTask& task, const Render& render, std::size_t l, NativeBand& band) {
  const Layer &layer = render.layers[l], &output = task.first().layers[l];
  const Rect area = area_of(band);
  const std::vector<std::string> channels = all_channels(layer), names = all_channels(output);
  const Rect& window = part_of(render, layer).data_window;
  const Rect rows{window.x0, std::max(window.y0, band.y0), window.x1, std::min(window.y1, band.y1)};
  if (rows.empty()) return;
  Imf::MultiPartInputFile container(file_of(render, layer).path.c_str(), 0, false);
  Imf::InputPart input(container, layer.part);
  NativeBand old(input.header());
  old.channels.erase(std::remove_if(old.channels.begin(), old.channels.end(),
                                    [&](const NativeChannel& c) {
                                      return std::find(channels.begin(), channels.end(), c.name) == channels.end();
                                    }),
                     old.channels.end());
  old.take_lines(rows.y0, rows.y1);
  read_band(input, old);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const NativeChannel& from = *old.find(channels[c]);
    NativeChannel& to = *band.find(output_name(task.first(), output, names[c]));
    if (from.type != to.type) misfit(render, task.first(), fmt::format("another type in layer {}", output.name));
    copy_common(from.samples.data(), rows, to.samples.data(), area, render.region.rect, size_of(to.type));
  }
}

}  // namespace

void copy_layer(const MergeTask& task, std::size_t l, NativeBand& band) {
  const Layer& layer = task.first().layers[l];
  for (const std::string& name : all_channels(layer)) {
    NativeChannel& to = *band.find(output_name(task.first(), layer, name));
    std::fill(to.samples.begin(), to.samples.end(), 0);
  }
  for (std::size_t k = task.renders.size(); k-- > 0;)
    if ((task.renders[k].absent.empty() || !task.renders[k].absent[l]) && !is_behind(task, k))
      copy_layer(task, task.renders[k], l, band);
}

}  // namespace polyrecon
