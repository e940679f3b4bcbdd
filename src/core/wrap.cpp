#include "core/wrap.h"

namespace polyrecon {

Image wrapped(const Image& image) {
  if (image.empty()) return image;
  const int width = image.width();
  Image out(width + 2 * wrap_margin, image.height(), image.channels());
  for (int from = 0, x = 0; x < out.width(); x += width - from, from = 0) {
    if (x == 0) from = (width - wrap_margin % width) % width;
    const int count = width - from < out.width() - x ? width - from : out.width() - x;
    paste(image, {from, 0, from + count, image.height()}, out, x, 0);
  }
  return out;
}

Image unwrapped(const Image& image) {
  if (image.empty()) return image;
  return crop(image, {wrap_margin, 0, image.width() - wrap_margin, image.height()});
}

void wrap(Frame& frame) {
  const auto wrap_pass = [](Pass& pass) {
    for (Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b}) *image = wrapped(*image);
  };
  wrap_pass(frame.beauty);
  wrap_pass(frame.prior);
  for (Feature& feature : frame.features) wrap_pass(feature.pass);
  for (Pass& aov : frame.aovs) wrap_pass(aov);
  for (Image* image : {&frame.alpha, &frame.sample_count, &frame.motion}) *image = wrapped(*image);
  frame.wraps = false;
}

}  // namespace polyrecon
