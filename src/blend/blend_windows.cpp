#include "blend/blend_windows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color_layout.h"
#include "core/fast_math.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/simd.h"
#include "regression/least_squares.h"
#include "regression/order_selection.h"
#include "regression/weights.h"
#include "regression/window.h"

namespace polyrecon {
namespace {

/// Channels of the blend sums that have one value per window, behind those of the response.
enum WindowConstant : std::size_t {
  RelativeBias = 0,
  Variance = RelativeBias + ColorLayout::primaries,
  Order = Variance + ColorLayout::primaries,
  Weight,
  Constants
};

/// Sums of equation (3) for one bandwidth over an area. Channels are interleaved, since a window adds to all of them at
/// each of its pixels: response | WindowConstant.
class BlendSums {
 public:
  /// Sets all sums of the area to zero.
  void begin(const Rect& area, int responses) {
    area_ = area;
    channels_ = static_cast<std::size_t>(responses) + Constants;
    sums_.assign(area.area() * channels_, 0.0);
  }

  std::size_t channels() const { return channels_; }
  double* at(int x, int y) {
    return sums_.data() + (static_cast<std::size_t>(y - area_.y0) * static_cast<std::size_t>(area_.width()) +
                           static_cast<std::size_t>(x - area_.x0)) *
                              channels_;
  }
  const Rect& area() const { return area_; }

 private:
  Rect area_;
  std::size_t channels_ = 0;
  std::vector<double> sums_;
};

/// The sums of the whole image, in storage precision.
struct BlendPlane {
  std::size_t channels;
  int width;
  std::vector<Real> sums;

  BlendPlane(int w, int h, int responses)
      : channels(static_cast<std::size_t>(responses) + Constants),
        width(w),
        sums(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * channels, Real(0)) {}
  Real* at(int x, int y) {
    return sums.data() +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * channels;
  }
  void add(BlendSums& block) {
    const Rect& r = block.area();
    for (int y = r.y0; y < r.y1; ++y) {
      Real* out = at(r.x0, y);
      const double* in = block.at(r.x0, y);
      for (std::size_t k = 0; k < static_cast<std::size_t>(r.width()) * channels; ++k)
        out[k] += static_cast<Real>(in[k]);
    }
  }
};

/// Buffers of a thread, allocated once.
struct Scratch {
  PatchDistances distances;
  Window window;
  NestedFactor factor;
  std::vector<Real> weight;
  std::vector<Real> fit;           ///< yhat, window.padded rows of fit_pitch values.
  std::vector<Real> bound_weight;  ///< Filled by within_bound.
  std::size_t fit_pitch = 0;
  std::vector<int> center_x, center_y;
  Rect centers;                 ///< Bounding box of the centres.
  std::vector<BlendSums> sums;  ///< One for each bandwidth.
};

constexpr std::size_t responses_at_once = vector_lanes;

/// Computes fit(j) = origin + sum_a f_a q_a(j) for all pixels j and responses_at_once adjacent responses.
POLYRECON_SIMD void evaluate_at_once(const Real* q, std::size_t pitch, const Real (*factor)[responses_at_once],
                                     int columns, const Real* origin, int rows, Real* fit, std::size_t fit_pitch) {
  constexpr std::size_t at_once = 4;  // pixels, so that factors are loaded once for all of them
  const Reals start = *reinterpret_cast<const StoredReals*>(origin);
  for (int j = 0; j < rows; j += at_once, q += at_once * pitch, fit += at_once * fit_pitch) {
    const Real *q0 = q, *q1 = q + pitch, *q2 = q1 + pitch, *q3 = q2 + pitch;
    Reals s0 = start, s1 = start, s2 = start, s3 = start;
    for (int a = 0; a < columns; ++a) {
      const Reals f = *reinterpret_cast<const StoredReals*>(factor[a]);
      s0 += q0[a] * f;
      s1 += q1[a] * f;
      s2 += q2[a] * f;
      s3 += q3[a] * f;
    }
    *reinterpret_cast<StoredReals*>(fit) = s0;
    *reinterpret_cast<StoredReals*>(fit + fit_pitch) = s1;
    *reinterpret_cast<StoredReals*>(fit + 2 * fit_pitch) = s2;
    *reinterpret_cast<StoredReals*>(fit + 3 * fit_pitch) = s3;
  }
}

POLYRECON_SIMD void energies(const Real* weight, const Real* guess, const Real* variance, int n, double* guess_energy,
                             double* noise_energy) {
  double guess_sum = 0, noise_sum = 0;
#pragma omp simd reduction(+ : guess_sum, noise_sum)
  for (int j = 0; j < n; ++j) {
    const double w = weight[j], m = guess[j];
    guess_sum += w * m * m;
    noise_sum += w * static_cast<double>(variance[j]);
  }
  *guess_energy = guess_sum;
  *noise_energy = noise_sum;
}

std::array<ColumnStatistics, 3> column_statistics(Scratch& s, bool first_stage) {
  std::array<ColumnStatistics, 3> channels;
  double *z[3], *guess_z[3], *variance[3];
  for (std::size_t c = 0; c < 3; ++c) {
    z[c] = channels[c].z.data();
    guess_z[c] = channels[c].guess.data();
    variance[c] = channels[c].variance.data();
  }
  project_beauty(s.factor, s.window, s.weight.data(), !first_stage, z, guess_z, variance);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t offset = c * static_cast<std::size_t>(s.window.stride);
    const Real* guess = (first_stage ? s.window.response : s.window.guess).data() + offset;
    energies(s.weight.data(), guess, s.window.noise_variance.data() + offset, s.window.padded,
             &channels[c].guess_energy, &channels[c].noise_energy);
  }
  return channels;
}

/// Computes yhat of every response channel at every pixel of the window: sum_a g_a z_a q_a plus the value at the
/// centre, which gather subtracted.
void evaluate(Scratch& s, const OrderChoice& choice, std::size_t responses,
              const std::array<ColumnStatistics, 3>& beauty) {
  std::array<double, BasisLayout::max_columns> z{};
  for (std::size_t first = 0; first < responses; first += responses_at_once) {
    Real factor[BasisLayout::max_columns][responses_at_once] = {}, origin[responses_at_once] = {};
    for (std::size_t k = 0; k < std::min(responses_at_once, responses - first); ++k) {
      const std::size_t c = first + k;
      const Real* const y = s.window.response.data() + c * static_cast<std::size_t>(s.window.stride);
      if (c >= 3) project(s.factor, s.window, s.weight.data(), y, z.data());
      const double* const coefficient = c < 3 ? beauty[c].z.data() : z.data();
      for (std::size_t i = 0; i < static_cast<std::size_t>(s.factor.kept); ++i) {
        const auto a = static_cast<std::size_t>(s.factor.kept_column[i]);
        factor[i][k] = static_cast<Real>(choice.factor[a] * coefficient[a]);
      }
      origin[k] = s.window.origin[c];
    }
    evaluate_at_once(s.factor.q.data(), static_cast<std::size_t>(s.window.pitch), factor, s.factor.kept, origin,
                     s.window.padded, s.fit.data() + first, s.fit_pitch);
  }
}

/// Computes energy = sum_i w_i yhat(i)^2 for the three channels of the beauty. Returns whether all values of the fit
/// are finite.
POLYRECON_SIMD bool energies_of_fit(const Real* fit, std::size_t pitch, std::size_t responses, const Real* weight,
                                    int count, double* energy) {
  Doubles sum = {}, rest = {};
  for (int j = 0; j < count; ++j, fit += pitch) {
    const Doubles f = __builtin_convertvector(*reinterpret_cast<const StoredReals*>(fit), Doubles);
    sum += static_cast<double>(weight[j]) * f * f;
    rest += f * 0.0;  // 0, or NaN where f is not finite
    for (std::size_t first = responses_at_once; first < responses; first += responses_at_once)
      rest += __builtin_convertvector(*reinterpret_cast<const StoredReals*>(fit + first), Doubles) * 0.0;
  }
  bool finite = true;
  for (int k = 0; k < vector_lanes; ++k) finite &= rest[k] == 0;
  for (int c = 0; c < 3; ++c) energy[c] = sum[c];
  return finite;
}

/// Multiplies the weight of each pixel of a window by exp(-max(0, d^2 / b - 1)), and by the inverse of large d^2 / b;
/// see BlendedFit.
POLYRECON_SIMD void within_bound(const Window& window, const Image& other, const Image& bound, const Real* fit,
                                 std::size_t pitch, const Real* weight, Real* out) {
  constexpr Real tiny = std::numeric_limits<Real>::min();  // so that 0 / 0 is 0
  constexpr Real most = 60;                                // exp(-most) / 1e6 is still a normal float
  const Real *red = other.plane(0), *green = other.plane(1), *blue = other.plane(2), *bounds = bound.plane(0);
  const int* const offset = window.offset.data();
  for (int j = 0; j < window.count; ++j, fit += pitch) {
    const auto i = static_cast<std::size_t>(offset[j]);
    const Real r = fit[0] - red[i], g = fit[1] - green[i], b = fit[2] - blue[i];
    const Real excess = (r * r + g * g + b * b) / (bounds[i] + tiny) - 1;
    // The exponential ends at `most`; this factor falls further, so that windows that contradict less count more.
    const Real ratio = excess > most ? most / excess : 1, beyond = ratio * ratio;
    const auto factor =
        beyond * static_cast<Real>(exp_minus(static_cast<float>(excess > 0 ? excess < most ? excess : most : 0)));
    out[j] = bounds[i] > 0 ? weight[j] * factor : 0;
  }
}

POLYRECON_SIMD void add_pixels(const Window& window, const Real* weight, const Real* fit, std::size_t pitch,
                               std::size_t responses, const double* constant, BlendSums& sums) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j) {
    const double w = static_cast<double>(weight[j]);
    if (w == 0) continue;
    double* out = sums.at(window.x[j], window.y[j]);
    for (std::size_t c = 0; c < responses; ++c) out[c] += w * static_cast<double>(fit[j * pitch + c]);
    for (std::size_t k = 0; k < Constants; ++k) out[responses + k] += w * constant[k];
  }
}

/// Adds a window to the sums. energy: weighted mean of yhat^2.
void blend(const FitSource& source, const OrderChoice& choice, const double* energy, std::size_t responses, Scratch& s,
           BlendSums& sums) {
  double constant[Constants];
  for (std::size_t c = 0; c < 3; ++c) {
    constant[RelativeBias + c] = std::sqrt((choice.error[c] - choice.variance[c]) / (energy[c] + source.epsilon));
    constant[Variance + c] = choice.variance[c];
  }
  constant[Order] = choice.order;
  constant[Weight] = 1;
  const Real* weight = s.weight.data();
  if (source.bound && !source.bound->empty()) {
    within_bound(s.window, *source.other, *source.bound, s.fit.data(), s.fit_pitch, weight, s.bound_weight.data());
    weight = s.bound_weight.data();
  }
  add_pixels(s.window, weight, s.fit.data(), s.fit_pitch, responses, constant, sums);
}

/// The state of one call of fit_and_blend.
struct Blending {
  const FitSource& source;
  const FitParams& params;
  BasisLayout layout;
  FitCounters& counters;
  const Image& mask;
  std::vector<BlendPlane> planes;

  std::size_t responses() const { return static_cast<std::size_t>(source.response->channels()); }
};

/// Fits the gathered window with the weights of one bandwidth and adds it to the sums.
void fit_window(Blending& b, Scratch& s, Real bandwidth, BlendSums& sums) {
  const bool first_stage = !b.source.guess;
  const BasisLayout& layout = s.window.layout;
  const double weight_sum = kernel_weights(s.window, bandwidth, s.weight.data());
  // All columns but the constant are zero in a window of one pixel.
  factorise(s.window, s.window.count > 1 ? layout.columns() : 1, s.weight.data(), s.factor);
  const auto statistics = column_statistics(s, first_stage);
  OrderChoice choice =
      select_order(statistics, layout, weight_sum, first_stage, b.params.order_tolerance, b.params.shrinkage);
  evaluate(s, choice, b.responses(), statistics);
  ++b.counters.windows;
  if (s.factor.rank < layout.columns()) ++b.counters.rank_deficient;
  double energy[3];
  if (!energies_of_fit(s.fit.data(), s.fit_pitch, b.responses(), s.weight.data(), s.window.count, energy)) {
    // The fit overflowed. Other windows cover the pixels of this one, or they keep the input.
    ++b.counters.dropped;
    return;
  }
  ++b.counters.per_model[static_cast<std::size_t>(choice.model)];
  for (double& e : energy) e /= weight_sum;
  blend(b.source, choice, energy, b.responses(), s, sums);
}

void work_block(Blending& b, const Rect& block, Scratch& s) {
  const FitParams& p = b.params;
  s.window.reserve(p.radius, b.layout.columns(), b.source.response->channels());
  s.weight.resize(static_cast<std::size_t>(s.window.stride));
  s.bound_weight.resize(s.weight.size());
  s.fit_pitch = (b.responses() + responses_at_once - 1) / responses_at_once * responses_at_once;
  s.fit.resize(static_cast<std::size_t>(s.window.stride) * s.fit_pitch);
  s.distances.load(*b.source.guide, *b.source.guide_variance, block, p.radius, p.patch, &b.mask);
  std::vector<Real> limits;
  for (const Real bandwidth : p.bandwidths) limits.push_back(cut_exponent * bandwidth * bandwidth);
  const WindowSource source{b.source.response, b.source.noise_variance, b.source.features, b.source.guess};
  for (std::size_t k = 0; k < s.center_x.size(); ++k) {
    s.distances.window_of(s.center_x[k], s.center_y[k], limits, s.window);
    if (s.window.count == 0) continue;
    gather(source, b.layout, s.center_x[k], s.center_y[k], p.radius, s.window);
    for (std::size_t h = 0; h < p.bandwidths.size(); ++h) {
      s.window.take(s.window.within[h]);
      if (s.window.count > 0) fit_window(b, s, p.bandwidths[h], s.sums[h]);
    }
  }
}

template <typename IsCenter>
void list_centers(const Rect& block, const IsCenter& is_center, Scratch& s) {
  s.center_x.clear();
  s.center_y.clear();
  s.centers = {block.x1, block.y1, block.x0, block.y0};
  for (int x = block.x0; x < block.x1; ++x)  // by columns, for which PatchDistances is fastest
    for (int y = block.y0; y < block.y1; ++y) {
      if (!is_center(x, y)) continue;
      s.center_x.push_back(x);
      s.center_y.push_back(y);
      s.centers = {std::min(s.centers.x0, x), std::min(s.centers.y0, y), x + 1, std::max(s.centers.y1, y + 1)};
    }
}

/// Fits windows around all centres for which is_center holds. Blocks of the same group (of block_groups) never add to
/// the same pixel, and the groups follow one another, so every pixel is summed in the same order for any number of
/// threads.
template <typename IsCenter>
void sweep(Blending& b, Progress& progress, const IsCenter& is_center) {
  const Rect bounds = b.source.response->bounds();
  const auto blocks = aligned_blocks(bounds, block_size);
  for (int group = 0; group < block_groups; ++group) {
    std::vector<Rect> mine;
    for (const Rect& r : blocks)
      if ((r.x0 / block_size) % 2 + 2 * ((r.y0 / block_size) % 2) == group) mine.push_back(r);
    parallel_for(mine.size(), progress, [&](std::size_t i) {
      thread_local Scratch scratch;
      list_centers(mine[i], is_center, scratch);
      if (scratch.center_x.empty()) return;
      scratch.sums.resize(b.planes.size());
      for (BlendSums& sums : scratch.sums)
        sums.begin(intersect(bounds, grow(scratch.centers, b.params.radius)), b.source.response->channels());
      work_block(b, mine[i], scratch);
      for (std::size_t h = 0; h < b.planes.size(); ++h) b.planes[h].add(scratch.sums[h]);
    });
  }
}

BlendedFit normalise(BlendPlane& plane, const FitSource& source, const std::vector<unsigned char>& active,
                     FitCounters& counters) {
  const Image &response = *source.response, &noise_variance = *source.noise_variance;
  const int width = response.width(), height = response.height(), channels = response.channels();
  BlendedFit out{Image(width, height, channels), Image(width, height, 3), Image(width, height, 3),
                 Image(width, height, 1)};
  for_rows(height, [&](int y) {
    std::size_t uncovered = 0;
    for (int x = 0; x < width; ++x) {
      const Real* sums = plane.at(x, y);
      const Real* const constant = sums + channels;
      const Real weight = constant[Weight];
      const bool covered = weight > std::numeric_limits<Real>::min();
      for (int c = 0; c < channels; ++c) out.value.at(x, y, c) = covered ? sums[c] / weight : response.at(x, y, c);
      if (!covered) {  // keeps the response; the variance is that of the mean of both halves, half that of one
        for (int c = 0; c < 3; ++c) out.variance.at(x, y, c) = Real(0.5) * noise_variance.at(x, y, c);
        uncovered += active[response.index(x, y)];
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const double f = out.value.at(x, y, c), energy = f * f + source.epsilon;
        const double bias = constant[RelativeBias + static_cast<std::size_t>(c)] / weight;
        out.squared_bias.at(x, y, c) = storable(bias * bias * energy);
        out.variance.at(x, y, c) = constant[Variance + static_cast<std::size_t>(c)] / weight;
      }
      out.order.at(x, y, 0) = constant[Order] / weight;
    }
    counters.uncovered_pixels += uncovered;
  });
  return out;
}

/// The centres whose windows cover an active pixel: the active pixels, grown by the window's radius.
std::vector<unsigned char> needed_centers(const std::vector<unsigned char>& active, int width, int height, int radius) {
  std::vector<unsigned char> rows(active.size(), 0), out(active.size(), 0);
  const auto spread = [&](const std::vector<unsigned char>& in, std::vector<unsigned char>& to, int lines, int length,
                          std::size_t line_step, std::size_t step) {
    for (int l = 0; l < lines; ++l) {
      int last = -2 * radius - 2;  // nearest active pixel before
      const std::size_t base = static_cast<std::size_t>(l) * line_step;
      for (int k = 0; k < length; ++k) {
        if (in[base + static_cast<std::size_t>(k) * step]) last = k;
        if (k - last <= radius) to[base + static_cast<std::size_t>(k) * step] = 1;
      }
      last = length + 2 * radius + 2;
      for (int k = length - 1; k >= 0; --k) {
        if (in[base + static_cast<std::size_t>(k) * step]) last = k;
        if (last - k <= radius) to[base + static_cast<std::size_t>(k) * step] = 1;
      }
    }
  };
  spread(active, rows, height, width, static_cast<std::size_t>(width), 1);
  spread(rows, out, width, height, 1, static_cast<std::size_t>(width));
  return out;
}

}  // namespace

std::size_t blended_fit_channels(std::size_t color_channels) {
  return color_channels + Constants - 1;  // all sums but the weight, which they are divided by
}

std::size_t blend_sums_channels(std::size_t color_channels) { return color_channels + Constants; }

int fit_halo(const FitParams& params) {
  // One radius from a pixel to the centres that cover it, and one from these to the pixels of their windows. Whether a
  // pixel is a centre of a finer lattice depends on the centres that cover it, whether these are centres on those of
  // the lattice before: one radius per lattice.
  int lattices = 1;
  for (int step = params.stride / 2; step >= 1; step /= 2) ++lattices;
  const int radii = std::max(lattices, 2);
  // Patches at the rim of the mask continue it by what is at most another patch radius away.
  return radii * params.radius + 2 * params.patch.radius + 1;
}

std::vector<BlendedFit> fit_and_blend(const FitSource& source, const std::vector<unsigned char>& active,
                                      const FitParams& params, FitCounters& counters, Progress& progress) {
  const int width = source.response->width(), height = source.response->height();
  const Image everywhere;
  const Image& mask = source.mask ? *source.mask : everywhere;
  Blending b{source, params, BasisLayout(source.features->channels(), params.max_order), counters, mask, {}};
  for (std::size_t h = 0; h < params.bandwidths.size(); ++h)
    b.planes.emplace_back(width, height, source.response->channels());
  const auto needed = needed_centers(active, width, height, params.radius);
  // Equal patches have weight 1, so sums equal to the coverage are common; the factor makes them count as covered in
  // spite of rounding.
  const double least_coverage = params.coverage * (1 - 1e-4);
  // The first lattice has all its centres. On each finer one only those pixels become centres that are covered by
  // unlike centres alone so far, which would make a bad blend.
  std::vector<unsigned char> is_center(active.size(), 0), done(active.size(), 0);
  for (int step = params.stride; step >= 1; step /= 2) {
    const BlendPlane& plane = b.planes.back();  // of the widest bandwidth
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = source.response->index(x, y);
        // Lattices start again in each block, so that a crop has the same ones for any stride.
        const bool on_lattice = x % block_size % step == 0 && y % block_size % step == 0;
        const bool sparse = static_cast<double>(plane.sums[(i + 1) * plane.channels - 1]) < least_coverage;
        is_center[i] =
            on_lattice && !done[i] && in_mask(mask, i) && (step == params.stride ? needed[i] : active[i] && sparse);
        done[i] |= is_center[i];
      }
    sweep(b, progress, [&](int x, int y) { return is_center[source.response->index(x, y)] != 0; });
  }
  std::vector<BlendedFit> out;
  for (BlendPlane& plane : b.planes) out.push_back(normalise(plane, source, active, counters));
  return out;
}

}  // namespace polyrecon
