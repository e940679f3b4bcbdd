#include "io/pictures/false_color.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Display-encoded colours of one of OpenImageIO's maps, whose tables are linear. level(value) is the position on the
/// map, 0 to 1. Values that are not finite become cyan.
Image mapped(const Image& values, const char* map, const std::function<double(double)>& level) {
  OIIO::ImageBuf levels(OIIO::ImageSpec(values.width(), values.height(), 1, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < values.height(); ++y)
    for (int x = 0; x < values.width(); ++x) {
      const auto sample = static_cast<float>(std::clamp(level(values.at(x, y, 0)), 0.0, 1.0));
      levels.setpixel(x, y, &sample, 1);
    }
  OIIO::ImageBuf colors;
  if (!OIIO::ImageBufAlgo::color_map(colors, levels, 0, map))
    throw Error(ExitCode::Internal, "false colours: " + colors.geterror());
  constexpr std::array<Real, 3> cyan{0, 1, 1};
  Image out(values.width(), values.height(), 3);
  for (int y = 0; y < values.height(); ++y)
    for (int x = 0; x < values.width(); ++x) {
      const bool finite = std::isfinite(values.at(x, y, 0));
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) =
            finite ? OIIO::linear_to_sRGB(colors.getchannel(x, y, 0, c)) : cyan[static_cast<std::size_t>(c)];
    }
  return out;
}

}  // namespace

Image false_color(const Image& values, const LogRange& range) {
  const double span = range.high > range.low ? std::log(range.high / range.low) : 1.0;
  const auto level = [&](double v) {
    return v > 0 && range.low > 0 ? (range.high > range.low ? std::log(v / range.low) / span : 1.0) : 0.0;
  };
  return mapped(values, "inferno", level);
}

Image flip_color(const Image& values) {
  return mapped(values, "magma", [](double v) { return v; });
}

}  // namespace polyrecon
