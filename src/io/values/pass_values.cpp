#include "io/values/pass_values.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/relmse.h"
#include "core/repair.h"
#include "io/renderers/known_names.h"
#include "io/values/cie_xyz.h"

namespace polyrecon {
namespace {

Image repeated(const Image& gray, int channels) {
  Image out(gray.width(), gray.height(), channels);
  for (int c = 0; c < channels; ++c) std::copy_n(gray.plane(0), gray.pixels(), out.plane(c));
  return out;
}

Image averaged(const Image& image, bool is_variance) {
  Image out(image.width(), image.height(), 1);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    double sum = 0;
    for (int c = 0; c < image.channels(); ++c) {
      const double value = image.plane(c)[i];
      sum += is_variance ? std::sqrt(value) : value;
    }
    const double mean = sum / image.channels();
    out.plane(0)[i] = static_cast<Real>(is_variance ? mean * mean : mean);
  }
  return out;
}

/// The unbiased variance of the mean of n samples, (m2 - mean^2) / (n - 1), at least 0; m2 is their mean square.
double variance_from_moment(double m2, double mean, double n) {
  const double spread = m2 - mean * mean;
  return spread < 0 ? 0 : spread / std::max(n - 1, 1.0);
}

void from_sample_variance(Image& values, const SampleCounts& counts) {
  for (int c = 0; c < values.channels(); ++c)
    for (std::size_t i = 0; i < values.pixels(); ++i) {
      Real& v = values.plane(c)[i];
      v = static_cast<Real>(v / std::max(counts.at(i), 1.0));
    }
}

void from_moment(Image& values, const Image& mean, const SampleCounts& counts) {
  for (int c = 0; c < values.channels(); ++c)
    for (std::size_t i = 0; i < values.pixels(); ++i) {
      Real& v = values.plane(c)[i];
      v = static_cast<Real>(variance_from_moment(v, mean.plane(std::min(c, mean.channels() - 1))[i], counts.at(i)));
    }
}

/// Replaces each pixel by xyz_to_rgb times to(value), with back() of the result.
template <class To, class Back>
void convert_xyz(Image& image, const To& to, const Back& back) {
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const Triple rgb = product(xyz_to_rgb, {to(image.plane(0)[i]), to(image.plane(1)[i]), to(image.plane(2)[i])});
    for (std::size_t c = 0; c < 3; ++c) image.plane(static_cast<int>(c))[i] = static_cast<Real>(back(rgb[c]));
  }
}

void from_moment_of_xyz(Image& values, const Image& mean, const SampleCounts& counts) {
  for (std::size_t i = 0; i < values.pixels(); ++i) {
    const Triple xyz = product(rgb_to_xyz, {mean.plane(0)[i], mean.plane(1)[i], mean.plane(2)[i]});
    for (std::size_t c = 0; c < 3; ++c) {
      Real& v = values.plane(static_cast<int>(c))[i];
      v = static_cast<Real>(variance_from_moment(v, xyz[c], counts.at(i)));
    }
  }
  xyz_to_rgb_variances(values);
}

/// Sums of relative variances over pairs of pixels.
struct PairSums {
  double stated = 0, shown = 0;
};

PairSums pairs_of_row(const Image& mean, const Image& variance, int c, int y) {
  const Real *m = mean.row(c, y), *v = variance.row(c, y);
  PairSums sums;
  for (int x = 0; x + 1 < mean.width(); ++x) {
    const double a = static_cast<double>(m[x]), b = static_cast<double>(m[x + 1]),
                 stated = (std::max(static_cast<double>(v[x]), 0.0) + std::max(static_cast<double>(v[x + 1]), 0.0)) / 2,
                 shown = (a - b) * (a - b) / 2, scale = relmse_denominator((a + b) / 2);
    if (!std::isfinite(stated / scale) || !std::isfinite(shown / scale)) continue;
    sums.stated += stated / scale;
    sums.shown += shown / scale;
  }
  return sums;
}

}  // namespace

void xyz_to_rgb_values(Image& xyz) {
  convert_xyz(
      xyz, [](double v) { return v; }, [](double v) { return v; });
}

void xyz_to_rgb_variances(Image& xyz) {
  convert_xyz(
      xyz, [](double v) { return std::sqrt(v); }, [](double v) { return v * v; });
}

Image with_channels(Image image, int channels, bool is_variance) {
  if (image.empty() || image.channels() == channels) return image;
  return channels == 1 ? averaged(image, is_variance) : repeated(image, channels);
}

std::size_t repair_counts(Image& counts) {
  const auto is_count = [](Real n) { return usable(n) && n >= 0; };
  double sum = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < counts.pixels(); ++i)
    if (const Real n = counts.plane(0)[i]; is_count(n)) sum += static_cast<double>(n), ++known;
  if (known == 0) return counts.pixels();
  std::replace_if(
      counts.plane(0), counts.plane(0) + counts.pixels(), [&](Real n) { return !is_count(n); },
      static_cast<Real>(sum / static_cast<double>(known)));
  return counts.pixels() - known;
}

double variance_excess(const Image& mean, const Image& variance) {
  if (variance.empty()) return 0;
  std::vector<PairSums> rows(static_cast<std::size_t>(mean.height()));
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < mean.channels(); ++c) {
      const PairSums row = pairs_of_row(mean, variance, c, y);
      rows[static_cast<std::size_t>(y)].stated += row.stated;
      rows[static_cast<std::size_t>(y)].shown += row.shown;
    }
  });
  PairSums all;
  for (const PairSums& row : rows) {
    all.stated += row.stated;
    all.shown += row.shown;
  }
  return all.shown > 0 ? all.stated / all.shown : 0;
}

bool to_sample_counts(Image& values, const std::string& pass, double everywhere) {
  if (!is_sample_fraction(pass)) return true;
  if (everywhere <= 0) return false;
  for (std::size_t i = 0; i < values.pixels(); ++i)
    values.plane(0)[i] = static_cast<Real>(values.plane(0)[i] * everywhere);
  return true;
}

void to_variance_of_mean(Image& values, Companion kind, const Image& mean, const SampleCounts& counts) {
  switch (kind) {  // without a default, so that the compiler names a kind that is missing
    case Companion::VarianceOfSample:
      return from_sample_variance(values, counts);
    case Companion::SecondMoment:
      return from_moment(values, mean, counts);
    case Companion::SecondMomentOfXyz:
      return from_moment_of_xyz(values, mean, counts);
    case Companion::VarianceOfMean:
    case Companion::Mean:
    case Companion::HalfA:
    case Companion::HalfB:
      return;
  }
}

}  // namespace polyrecon
