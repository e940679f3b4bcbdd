#include "sweep/pictures.h"

#include <algorithm>
#include <cmath>

#include "core/relmse.h"
#include "core/resample.h"
#include "io/pictures/color.h"
#include "io/pictures/false_color.h"
#include "io/pictures/png_file.h"

namespace polyrecon {
namespace {

constexpr int widest = 640, parts = 4;

/// Mean over the channels of relative_squared_error.
Image relative_error(const Image& image, const Image& reference) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      out.plane(0)[i] += relative_squared_error(image.plane(c)[i], reference.plane(c)[i]) * Real(1.0 / 3);
    }
  return out;
}

/// The part with the largest sum of errors. A pixel counts at most 1, so that a single firefly does not decide.
Rect worst_part(const std::vector<Image>& errors, const Rect& frame) {
  const int width = std::max(frame.width() / parts, 1), height = std::max(frame.height() / parts, 1);
  const int step_x = std::max(width / 2, 1), step_y = std::max(height / 2, 1);
  Rect worst;
  double most = -1;
  for (int y = 0; y + height <= frame.y1; y += step_y)
    for (int x = 0; x + width <= frame.x1; x += step_x) {
      double sum = 0;
      for (const Image& error : errors)
        for (int v = y; v < y + height; ++v)
          for (int u = x; u < x + width; ++u)
            if (std::isfinite(error.at(u, v, 0))) sum += std::min(static_cast<double>(error.at(u, v, 0)), 1.0);
      if (sum > most) {
        most = sum;
        worst = {x, y, x + width, y + height};
      }
    }
  return worst;
}

}  // namespace

std::vector<PicturedResult> picture_results(const std::vector<Picture>& pictures, const Image& reference) {
  std::vector<Image> errors;
  for (const Picture& picture : pictures) errors.push_back(relative_error(*picture.linear, reference));
  // The first picture is the noisy one, whose errors are large everywhere: it does not help to find the part.
  const Rect part = worst_part({errors.begin() + (errors.size() > 1 ? 1 : 0), errors.end()}, reference.bounds());
  LogRange range;
  for (const Image& error : errors) {
    const LogRange found = log_range(error);
    if (found.high > range.high) range = found;
  }
  std::vector<PicturedResult> results;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Image display = to_display(*pictures[i].linear, {});
    PicturedResult result{pictures[i].name,
                          pictures[i].details,
                          png_data_uri(at_most_wide(display, widest)),
                          png_data_uri(crop(display, part)),
                          {}};
    if (pictures[i].linear != &reference)
      result.error = png_data_uri(at_most_wide(false_color(errors[i], range), widest));
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace polyrecon
