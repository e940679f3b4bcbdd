#include "temporal/geometry.h"

#include <algorithm>
#include <cmath>

#include "core/halves.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

constexpr double least_depth = 1e-6;  // depths below it, and 0 of an empty background, are one

void to_logarithm(Image& depth, double sky) {
  for (std::size_t i = 0; i < depth.pixels(); ++i) {
    const auto z = static_cast<double>(depth.plane(0)[i]);
    depth.plane(0)[i] = static_cast<Real>(std::log(std::isnan(z) ? sky : std::clamp(z, least_depth, sky)));
  }
}

}  // namespace

std::size_t geometry_channels() {
  int channels = info_of(Role::Motion).channels;
  for (const RoleInfo& info : role_table())
    if (info.surface != Surface::None) channels += info.channels;
  return static_cast<std::size_t>(channels);
}

Geometry geometry_of(const Frame& frame) {
  Geometry out{frame.data_window, frame.motion, {}};
  for (const Feature& feature : frame.features) {
    const Surface surface = info_of(feature.role).surface;
    if (surface == Surface::None) continue;
    Image& image = out.surface[index_of(surface)];
    image = feature.pass.mean;
    if (surface == Surface::Distance) to_logarithm(image, frame.sky_depth);
    repair_nonfinite(image, repair_depth);
  }
  return out;
}

std::array<Image, surfaces> surface_noise(const Frame& frame) {
  std::array<Image, surfaces> out;
  for (const Feature& feature : frame.features) {
    const Surface surface = info_of(feature.role).surface;
    if (surface == Surface::None || !feature.pass.noise_is_known()) continue;
    Image& noise = out[index_of(surface)];
    noise = Image(frame.width(), frame.height(), 1);
    for (int c = 0; c < feature.pass.mean.channels(); ++c)
      for (std::size_t i = 0; i < noise.pixels(); ++i)
        noise.plane(0)[i] += static_cast<Real>(known_variance(feature.pass, c, i));
  }
  return out;
}

Geometry crop(const Geometry& geometry, const Rect& r) {
  const Rect& w = geometry.window;
  Geometry out{{w.x0 + r.x0, w.y0 + r.y0, w.x0 + r.x1, w.y0 + r.y1}, {}, {}};
  for (std::size_t s = 0; s < surfaces; ++s)
    if (!geometry.surface[s].empty()) out.surface[s] = crop(geometry.surface[s], r);
  return out;
}

}  // namespace polyrecon
