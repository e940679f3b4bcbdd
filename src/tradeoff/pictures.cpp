#include "tradeoff/pictures.h"

#include <algorithm>
#include <cmath>

#include "io/color.h"
#include "io/preview.h"

namespace polyrecon {
namespace {

constexpr int widest = 640, parts = 4;

/// Mean over blocks of factor x factor pixels.
Image reduced(const Image& image) {
  const int factor = (image.width() + widest - 1) / widest;
  if (factor <= 1) return image;
  Image out((image.width() + factor - 1) / factor, (image.height() + factor - 1) / factor, image.channels());
  for (int c = 0; c < out.channels(); ++c)
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) {
        const Rect block = intersect({x * factor, y * factor, (x + 1) * factor, (y + 1) * factor}, image.bounds());
        double sum = 0;
        for (int v = block.y0; v < block.y1; ++v)
          for (int u = block.x0; u < block.x1; ++u) sum += static_cast<double>(image.at(u, v, c));
        out.at(x, y, c) = static_cast<Real>(sum / static_cast<double>(block.area()));
      }
  return out;
}

/// Mean over the channels of (x - r)^2 / (r^2 + 0.01).
Image relative_error(const Image& image, const Image& reference) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      const Real d = image.plane(c)[i] - reference.plane(c)[i], r = reference.plane(c)[i];
      out.plane(0)[i] += d * d / (r * r + Real(0.01)) * Real(1.0 / 3);
    }
  return out;
}

/// Where the errors sum to most, each pixel's counted as at most 1 so that a single firefly does not decide.
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
  // The first picture is the noisy one, which is bad everywhere: it says nothing of where results are.
  const Rect part = worst_part({errors.begin() + (errors.size() > 1 ? 1 : 0), errors.end()}, reference.bounds());
  LogRange range;
  for (const Image& error : errors) {
    const LogRange own = log_range(error);
    if (own.high > range.high) range = own;
  }
  std::vector<PicturedResult> results;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Image display = to_display(*pictures[i].linear, {});
    PicturedResult result{
        pictures[i].name, pictures[i].details, png_data_uri(reduced(display)), png_data_uri(crop(display, part)), {}};
    if (pictures[i].linear != &reference) result.error = png_data_uri(reduced(false_color(errors[i], range)));
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace polyrecon
