#include "core/resample.h"

#include <algorithm>

#include "core/mask.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {

Image half_resolution(const Image& image) {
  Image out((image.width() + 1) / 2, (image.height() + 1) / 2, image.channels());
  for_rows(out.height(), [&](int y) {
    const int y1 = std::min(2 * y + 1, image.height() - 1);
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        // At the border of an odd size the last row or column counts twice, which gives the mean over fewer pixels.
        const int x1 = std::min(2 * x + 1, image.width() - 1);
        out.at(x, y, c) = Real(0.25) * (image.at(2 * x, 2 * y, c) + image.at(x1, 2 * y, c) + image.at(2 * x, y1, c) +
                                        image.at(x1, y1, c));
      }
  });
  return out;
}

Image double_resolution(const Image& image, int width, int height) {
  Image out(width, height, image.channels());
  for_rows(height, [&](int y) {
    // The centre of fine pixel y is at coarse coordinate y / 2 - 1 / 4: 3/4 of the coarse pixel that contains it and
    // 1/4 of the next one.
    const int y0 = y / 2, y1 = std::clamp(y % 2 == 0 ? y0 - 1 : y0 + 1, 0, image.height() - 1);
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < width; ++x) {
        const int x0 = x / 2, x1 = std::clamp(x % 2 == 0 ? x0 - 1 : x0 + 1, 0, image.width() - 1);
        const Real near = Real(0.75) * image.at(x0, y0, c) + Real(0.25) * image.at(x1, y0, c);
        const Real far = Real(0.75) * image.at(x0, y1, c) + Real(0.25) * image.at(x1, y1, c);
        out.at(x, y, c) = Real(0.75) * near + Real(0.25) * far;
      }
  });
  return out;
}

Image half_resolution(const Image& image, const Image& mask) {
  if (mask.empty()) return half_resolution(image);
  return divided_by_share(half_resolution(outside_set_to(0, mask, image)), half_resolution(mask));
}

Image double_resolution(const Image& image, int width, int height, const Image& mask) {
  if (mask.empty()) return double_resolution(image, width, height);
  return divided_by_share(double_resolution(outside_set_to(0, mask, image), width, height),
                          double_resolution(mask, width, height));
}

Image reduced(const Image& image, int factor) {
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

}  // namespace polyrecon
