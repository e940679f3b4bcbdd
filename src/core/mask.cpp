#include "core/mask.h"

#include <algorithm>

#include "core/parallel.h"

namespace polyrecon {
namespace {

/// Calls change(sample, index of the pixel) for all samples of an image.
template <typename Change>
void for_samples(Image& image, const Change& change) {
  if (image.empty()) return;
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < image.width(); ++x) change(image.at(x, y, c), image.index(x, y));
  });
}

}  // namespace

std::size_t mask_pixels(const Image& mask, std::size_t all) {
  if (mask.empty()) return all;
  return static_cast<std::size_t>(std::count(mask.plane(0), mask.plane(0) + mask.pixels(), Real(1)));
}

Image both_masks(const Image& a, const Image& b) { return a.empty() ? b : outside_set_to(0, b, a); }

Image outside_set_to(Real value, const Image& mask, Image image) {
  if (mask.empty()) return image;
  for_samples(image, [&](Real& sample, std::size_t i) {
    if (!in_mask(mask, i)) sample = value;
  });
  return image;
}

Image divided_by_share(Image average, const Image& share) {
  for_samples(average, [&](Real& sample, std::size_t i) {
    if (share.plane(0)[i] > 0) sample /= share.plane(0)[i];
  });
  return average;
}

}  // namespace polyrecon
