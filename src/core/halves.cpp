#include "core/halves.h"

#include "core/parallel.h"

namespace polyrecon {

Image mean_of_halves(const std::array<Image, 2>& halves, int channels) {
  Image out(halves[0].width(), halves[0].height(), channels);
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < channels; ++c) {
      const Real *a = halves[0].row(c, y), *b = halves[1].row(c, y);
      Real* mean = out.row(c, y);
      for (int x = 0; x < out.width(); ++x) mean[x] = Real(0.5) * (a[x] + b[x]);
    }
  });
  return out;
}

}  // namespace polyrecon
