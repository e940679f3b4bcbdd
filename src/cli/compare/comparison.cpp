#include "cli/compare/comparison.h"

#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "metrics/flicker.h"
#include "metrics/flip.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

Comparison compare_layers(const LayeredFile& image, const Layer& layer, const LayeredFile& reference,
                          const Layer& reference_layer, bool with_images, Progress& progress) {
  Image x = read_radiance(image, layer), r = read_radiance(reference, reference_layer);
  if (!x.same_shape(r))
    throw Error(ExitCode::BadInput,
                fmt::format("{}: layer '{}' has {} x {} pixels, the reference has {} x {}", image.info.path, layer.name,
                            x.width(), x.height(), r.width(), r.height()));
  KnownVariance known = read_variance(reference, reference_layer, r);
  Comparison found;
  found.image = image.info.path;
  found.layer = layer.name;
  found.score = score(x, r, known.variance);
  found.note = std::move(known.note);
  Image map = flip(x, r, progress);
  found.flip = std::accumulate(map.plane(0), map.plane(0) + map.pixels(), 0.0) / static_cast<double>(map.pixels());
  if (with_images) {
    const Rect window = reference.info.parts[static_cast<std::size_t>(reference_layer.part)].data_window;
    found.x = window.x0;
    found.y = window.y0;
    found.error = relative_error(x, r);
    found.picture = std::move(x);
    found.reference = std::move(r);
    found.reference_variance = std::move(known.variance);
    found.flip_map = std::move(map);
  }
  return found;
}

}  // namespace

std::vector<Comparison> compare_files(const LayeredFile& image, const LayeredFile& reference, bool with_images,
                                      Progress& progress) {
  const Layer& main = require_color_layer(image);
  const Layer& main_reference = require_color_layer(reference);
  std::vector<Comparison> found;
  found.push_back(compare_layers(image, main, reference, main_reference, with_images, progress));
  for (const Layer& layer : image.layers)
    if (const Layer* same = find_layer(reference, layer.name);
        &layer != &main && same && is_color(layer) && is_color(*same))
      found.push_back(compare_layers(image, layer, reference, *same, with_images, progress));
  return found;
}

std::optional<double> flicker_since(const std::vector<Comparison>& before, const Comparison& now) {
  for (const Comparison& c : before)
    if (c.layer == now.layer && c.picture.same_shape(now.picture))
      return flicker({now.picture, now.reference, now.reference_variance},
                     {c.picture, c.reference, c.reference_variance});
  return std::nullopt;
}

Comparison without_images(const Comparison& comparison) {
  Comparison figures;
  figures.image = comparison.image;
  figures.layer = comparison.layer;
  figures.score = comparison.score;
  figures.flip = comparison.flip;
  figures.note = comparison.note;
  figures.frame = comparison.frame;
  figures.flicker = comparison.flicker;
  return figures;
}

std::string shown_layer(const Comparison& comparison) { return comparison.layer.empty() ? "RGB" : comparison.layer; }

}  // namespace polyrecon
