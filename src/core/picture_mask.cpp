#include "core/picture_mask.h"

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

std::size_t picture_pixels(const Image& picture, std::size_t all) {
  if (picture.empty()) return all;
  return static_cast<std::size_t>(std::count(picture.plane(0), picture.plane(0) + picture.pixels(), Real(1)));
}

Image outside_set_to(Real value, const Image& picture, Image image) {
  if (picture.empty()) return image;
  for_samples(image, [&](Real& sample, std::size_t i) {
    if (!in_picture(picture, i)) sample = value;
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
