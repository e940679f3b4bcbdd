#include "cli/common/comparison.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "metrics/flicker.h"
#include "metrics/flip.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Means of the radiance over blocks, so that the noise of a render counts little, on a logarithmic scale.
std::vector<double> blocks_of(const Image& image) {
  constexpr int block = 16;
  std::vector<double> means;
  for (int y = 0; y + block <= image.height(); y += block)
    for (int x = 0; x + block <= image.width(); x += block) {
      double sum = 0;
      for (int c = 0; c < image.channels(); ++c)
        for (int j = y; j < y + block; ++j)
          for (int i = x; i < x + block; ++i)
            if (const double value = image.at(i, j, c); std::isfinite(value) && value > 0) sum += value;
      means.push_back(std::log(1e-4 + sum / (block * block * image.channels())));
    }
  return means;
}

/// Correlation of the two; 1 where one of them has no structure that it could be measured by.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t least = 16;
  if (a.size() < least) return 1;
  const auto n = static_cast<double>(a.size());
  double mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  constexpr double no_structure = 1e-6;
  return aa / n > no_structure && bb / n > no_structure ? ab / std::sqrt(aa * bb) : 1;
}

/// A note about two pictures that do not show the same; empty for those that do.
std::string note_of_unrelated(const std::string& path, const Image& x, const Image& r) {
  constexpr double related = 0.5;
  const double found = correlation(blocks_of(x), blocks_of(r));
  if (found >= related) return {};
  return fmt::format("{} and the reference have little in common (correlation {:.2f}): is it the same frame?", path,
                     found);
}

/// A note where pixels of the reference are not finite; empty where all are.
std::string note_of_bad_reference(const std::string& path, const std::string& layer, const Image& r) {
  std::size_t bad = 0;
  for (std::size_t i = 0; i < r.pixels(); ++i)
    for (int c = 0; c < r.channels(); ++c)
      if (!std::isfinite(r.plane(c)[i])) {
        ++bad;
        break;
      }
  if (bad == 0) return {};
  return fmt::format(
      "{}: layer '{}': {} of {} pixels are not finite, so there are no figures: render the reference anew", path, layer,
      bad, r.pixels());
}

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
  for (const std::string& note : {note_of_unrelated(image.info.path, x, r),
                                  note_of_bad_reference(reference.info.path, reference_layer.name, r), known.note})
    if (!note.empty()) found.notes.push_back(note);
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
  figures.notes = comparison.notes;
  figures.frame = comparison.frame;
  figures.flicker = comparison.flicker;
  return figures;
}

std::string shown_layer(const Comparison& comparison) { return comparison.layer.empty() ? "RGB" : comparison.layer; }

}  // namespace polyrecon
