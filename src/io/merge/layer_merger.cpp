#include "io/merge/layer_merger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/parallel.h"
#include "core/rect.h"
#include "io/merge/area.h"
#include "io/merge/output.h"
#include "io/values/beyond_range.h"

namespace polyrecon {
namespace {

constexpr std::size_t renders_at_once = 16;                   // that are decoded before they are added up
constexpr std::size_t pixels_at_once = std::size_t{1} << 12;  // of one channel, whose sums stay in the cache

/// Whether a render has samples of a layer in all pixels of an area. A feature whose part is cut off within the window
/// of the render is not black beyond it, and zeros would draw an edge. Beyond the window all layers are black.
bool has_samples(const Render& render, std::size_t l, const Rect& area) {
  const Layer& layer = render.layers[l];
  const Rect shown = intersect(area, render.window);
  return !info_of(layer.role).feature || shown.empty() || intersect(part_of(render, layer).data_window, shown) == shown;
}

/// Pixel i of a band.
Rect pixel_of(const NativeBand& band, std::size_t i) {
  const auto width = static_cast<std::size_t>(band.width);
  const int x = band.x0 + static_cast<int>(i % width), y = band.y0 + static_cast<int>(i / width);
  return {x, y, x + 1, y + 1};
}

}  // namespace

void LayerMerger::merge(const Weights& weights, NativeBand& band) {
  if (task_.slots.empty()) return;
  const std::size_t pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.y1 - band.y0);
  std::vector<ChannelSums> sums(task_.slots.size(), ChannelSums(pixels));
  for (std::size_t k = 0; k < task_.renders.size(); k += renders_at_once)
    add_renders(k, std::min(k + renders_at_once, task_.renders.size()), weights, band, sums);
  in_parallel(task_.slots.size(), [&](std::size_t s) {
    const std::size_t l = task_.slots[s].layer;
    const Layer& layer = task_.first().layers[l];
    if (task_.slots[s].channel < layer.channels.size())
      write_channel(l, layer.channels[task_.slots[s].channel], sums[s], band);
    else
      write_mean(l, *band.find(output_name(task_.first(), layer, layer.alpha)), sums[s], band);
  });
}

LayerMerger::DecodedRender LayerMerger::decode(std::size_t k, const NativeBand& band) {
  const Render& render = task_.renders[k];
  const std::size_t pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.y1 - band.y0);
  DecodedRender decoded;
  decoded.planes.resize(task_.slots.size());
  std::set<std::pair<int, int>> parts;  // file and part
  for (const Slot& slot : task_.slots) parts.insert({render.layers[slot.layer].file, render.layers[slot.layer].part});
  for (const auto& [file, part] : parts) {
    std::vector<std::string> channels;
    std::vector<std::size_t> slots;
    for (std::size_t s = 0; s < task_.slots.size(); ++s) {
      const Layer& layer = render.layers[task_.slots[s].layer];
      if (layer.file != file || layer.part != part) continue;
      channels.push_back(all_channels(layer)[task_.slots[s].channel]);
      slots.push_back(s);
    }
    decoded.samples.push_back(read_area(render.files[static_cast<std::size_t>(file)], part, channels, area_of(band)));
    for (std::size_t c = 0; c < slots.size(); ++c) {
      const std::size_t l = task_.slots[slots[c]].layer;
      const Layer& layer = render.layers[l];
      float* plane = decoded.samples.back().data() + c * pixels;
      const BeyondRange beyond = beyond_range(part_of(render, layer), layer, layer.role, channels[c]);
      if (beyond == BeyondRange::LargestHalf)
        lone_overflows_[l] += drop_fireflies(render, layer, channels[c], band, plane);
      overflows_[l] += bring_into_range(beyond, plane, pixels);
      decoded.planes[slots[c]] = plane;
    }
  }
  return decoded;
}

std::size_t LayerMerger::drop_fireflies(const Render& render, const Layer& layer, const std::string& channel,
                                        const NativeBand& band, float* plane) {
  const Rect area = area_of(band);
  float* const end = plane + area.area();
  if (std::find(plane, end, std::numeric_limits<float>::infinity()) == end) return 0;
  // The lines next to the band tell a firefly from the last line of a lamp.
  const Rect around{area.x0, area.y0 - lone_reach, area.x1, area.y1 + lone_reach};
  std::vector<float> samples =
      read_area(render.files[static_cast<std::size_t>(layer.file)], layer.part, {channel}, around);
  drop_lone_overflows(samples.data(), around.width(), around.height());
  const float* from = samples.data() + static_cast<std::ptrdiff_t>(lone_reach) * area.width();
  std::size_t dropped = 0;
  for (float* to = plane; to != end; ++to, ++from) {
    if (!std::isinf(*to) || !std::isnan(*from)) continue;
    *to = *from;
    ++dropped;
  }
  return dropped;
}

void LayerMerger::add_renders(std::size_t first, std::size_t end, const Weights& weights, const NativeBand& band,
                              std::vector<ChannelSums>& sums) {
  std::vector<DecodedRender> decoded(end - first);
  in_parallel(decoded.size(), [&](std::size_t i) { decoded[i] = decode(first + i, band); });
  const std::size_t pixels = sums.front().all.size();
  const std::size_t blocks = (pixels + pixels_at_once - 1) / pixels_at_once;
  in_parallel(task_.slots.size() * blocks, [&](std::size_t work) {
    const std::size_t slot = work / blocks, begin = work % blocks * pixels_at_once;
    const std::string& view_layer = task_.renders.front().layers[task_.slots[slot].layer].view_layer;
    for (std::size_t k = first; k < end; ++k) {
      const auto known = weights[k].find(view_layer);
      const double* n = known == weights[k].end() ? nullptr : known->second.data();
      const float* samples = decoded[k - first].planes[slot];
      const Render& render = task_.renders[k];
      const std::size_t l = task_.slots[slot].layer;
      const bool everywhere = has_samples(render, l, area_of(band));
      for (std::size_t i = begin; i < std::min(begin + pixels_at_once, pixels); ++i)
        if (everywhere || has_samples(render, l, pixel_of(band, i))) add(sums[slot], i, samples[i], n ? n[i] : 1, k);
    }
  });
}

void LayerMerger::add(ChannelSums& sums, std::size_t i, float x, double weight, std::size_t k) {
  if (weight <= 0) return;
  if (!std::isfinite(x)) {
    ++left_out_;
    return;
  }
  sums.all[i].add(x, weight);
  (task_.half_b[k] ? sums.half_b : sums.half_a)[i].add(x, weight);
}

LayerMerger::Moments LayerMerger::moments(std::size_t l, const ChannelSums& sums, std::size_t i,
                                          const NativeBand& band) const {
  const Accumulator& all = sums.all[i];
  const MeanAccumulator &a = sums.half_a[i], &b = sums.half_b[i];
  if (all.renders == 0) {
    const Rect pixel = pixel_of(band, i);
    const bool sampled = std::any_of(task_.renders.begin(), task_.renders.end(), [&](const Render& render) {
      return intersect(render.region.rect, pixel) == pixel && has_samples(render, l, pixel);
    });
    const double value = sampled ? std::numeric_limits<double>::quiet_NaN() : 0;
    return {value, value};
  }
  if (!task_.halves_weigh_alike || a.renders == 0 || b.renders == 0) return {all.mean, all.variance_of_mean()};
  const double of_a_sample = all.variance_of_mean() * all.weight;
  return {(a.mean + b.mean) / 2, of_a_sample * (1 / a.weight + 1 / b.weight) / 4};
}

void LayerMerger::write_mean(std::size_t l, NativeChannel& channel, const ChannelSums& sums,
                             const NativeBand& band) const {
  for (std::size_t i = 0; i < sums.all.size(); ++i) put(channel, i, moments(l, sums, i, band).mean);
}

void LayerMerger::write_channel(std::size_t l, const std::string& name, const ChannelSums& sums, NativeBand& band) {
  const Layer& layer = task_.first().layers[l];
  NativeChannel& mean = *band.find(output_name(task_.first(), layer, name));
  if (task_.joins) return write_mean(l, mean, sums, band);
  NativeChannel& variance = *band.find(output_name(task_.first(), layer, name, variance_suffix));
  NativeChannel& half_a = *band.find(output_name(task_.first(), layer, name, half_a_suffix));
  NativeChannel& half_b = *band.find(output_name(task_.first(), layer, name, half_b_suffix));
  bool spread = false;
  for (std::size_t i = 0; i < sums.all.size(); ++i) {
    const Moments whole = moments(l, sums, i, band);
    spread = spread || sums.all[i].spreads();
    put(mean, i, whole.mean);
    put(variance, i, whole.variance);
    put(half_a, i, sums.half_a[i].renders > 0 ? sums.half_a[i].mean : whole.mean);
    put(half_b, i, sums.half_b[i].renders > 0 ? sums.half_b[i].mean : whole.mean);
  }
  if (spread) any_spread_ = true;
}

void LayerMerger::note(MergeResult& report) const {
  if (left_out_ > 0)
    report.notes.push_back(fmt::format("{} samples that are not finite were left out of the means", left_out_.load()));
  for (std::size_t l = 0; l < overflows_.size(); ++l) {
    const std::string& name = task_.first().layers[l].name;
    if (lone_overflows_[l] > 0) report.notes.push_back(lone_overflow_note(name, lone_overflows_[l]));
    if (overflows_[l] > 0) report.notes.push_back(overflow_note(name, overflows_[l]));
  }
  if (!task_.merged.empty() && !task_.joins && !any_spread_)
    report.notes.emplace_back("the renders are equal in every pixel: were they made with the same seed or offset?");
}

std::size_t LayerMerger::bytes_per_pixel() {
  return ChannelSums::bytes_per_pixel + (output_companions.size() + read_area_copies * renders_at_once) * sizeof(float);
}

}  // namespace polyrecon
