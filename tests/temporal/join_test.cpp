#include "temporal/join.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "polyrecon/reconstruct.h"
#include "support/images.h"
#include "support/scene.h"
#include "temporal/follow.h"

namespace polyrecon {
namespace {

constexpr int width = 64, height = 48;
constexpr double sigma = 0.1;

/// mu(x, y) of a frame; frame 0 is the current one.
using Truth = std::function<double(int frame, int x, int y)>;

double texture(double x, double y) { return 1 + 0.3 * std::sin(0.9 * x) * std::cos(0.7 * y); }

Image truth_of(const Truth& truth, int frame, int h = height) {
  return test::image_of(width, h, 3, [&](int x, int y, int c) { return (1 + 0.2 * c) * truth(frame, x, y); });
}

/// Motion of the whole picture by (dx, dy) pixels a frame.
Image motion_of(double dx, double dy, int h = height) {
  return test::image_of(width, h, 4, [&](int, int, int c) { return c == 0 ? -dx : c == 1 ? -dy : c == 2 ? dx : dy; });
}

/// A frame with `radius` neighbours on each side, all with independent noise.
struct Sequence {
  Image truth;
  Geometry geometry;
  std::array<Image, surfaces> noise;
  HalfPair pair;
  std::vector<Neighbour> frames;
  std::vector<TimedNeighbour> neighbours;

  Sequence(const Truth& of, Image vectors, int radius = 2, int h = height)
      : geometry{{0, 0, width, h}, std::move(vectors), {}} {
    truth = truth_of(of, 0, h);
    pair = test::pair_of(truth, sigma, 1);
    frames.reserve(16);
    for (int k = -radius; k <= radius; ++k) {
      if (k == 0) continue;
      frames.push_back({test::pair_of(truth_of(of, k, h), sigma, static_cast<std::uint64_t>(10 + k)), geometry});
      neighbours.push_back({k, &frames.back()});
    }
  }

  JoinCounts join(int radius = 2) {
    TemporalParams params;
    params.radius = radius;
    return join_neighbours(geometry, noise, neighbours, params, pair, silent_progress());
  }

  /// Shows a surface in all frames; of(k, x, y, c) is that of frame k.
  template <typename Values>
  void show(Surface surface, int channels, const Values& of) {
    const auto image = [&](int k) {
      return test::image_of(width, truth.height(), channels, [&](int x, int y, int c) { return of(k, x, y, c); });
    };
    geometry.surface[index_of(surface)] = image(0);
    for (std::size_t n = 0; n < frames.size(); ++n)
      frames[n].geometry.surface[index_of(surface)] = image(neighbours[n].offset);
  }

  /// Mean squared error of both halves, where take(x, y).
  double error(const std::function<bool(int, int)>& take = [](int, int) { return true; }) const {
    double sum = 0, count = 0;
    for (int y = 0; y < truth.height(); ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3 && take(x, y); ++c)
          for (const Image& half : pair.color) {
            const double d = static_cast<double>(half.at(x, y, c)) - static_cast<double>(truth.at(x, y, c));
            sum += d * d;
            ++count;
          }
    return sum / count;
  }

  double claimed() const {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < pair.variance.pixels(); ++i) sum += static_cast<double>(pair.variance.plane(c)[i]);
    return sum / (3.0 * static_cast<double>(pair.variance.pixels()));
  }
};

/// Five frames of one picture: the mean of all has a fifth of the variance. The weights exclude a few neighbours by
/// chance, so the gain is a little less; the stated variance must be the true one within 10 %.
TEST(JoinNeighbours, AveragesWhatStandsStill) {
  Sequence s([](int, int x, int y) { return texture(x, y); }, Image());
  const JoinCounts counts = s.join();
  EXPECT_EQ(counts.neighbours, 4u);
  EXPECT_GT(counts.weight, 3);
  EXPECT_LT(s.error(), 0.25 * sigma * sigma);
  EXPECT_NEAR(s.claimed() / s.error(), 1, 0.1);
}

TEST(JoinNeighbours, FollowsTheMotion) {
  const Truth moving = [](int frame, int x, int y) { return texture(x - 3 * frame, y + 2 * frame); };
  Sequence with(moving, motion_of(3, -2)), without(moving, Image());
  with.join();
  without.join();
  const auto inner = [](int x, int y) { return x > 8 && y > 8 && x < width - 8 && y < height - 8; };
  EXPECT_LT(with.error(inner), 0.25 * sigma * sigma);
  EXPECT_LT(without.error(inner),
            1.1 * sigma * sigma);  // without vectors no neighbour matches, and there are no ghosts
}

/// Between pixels the cubic keeps a texture of 7 pixels' period to a few percent of its amplitude, below the noise.
TEST(JoinNeighbours, FollowsMotionByPartsOfAPixel) {
  Sequence s([](int frame, int x, int y) { return texture(x - 1.3 * frame, y); }, motion_of(1.3, 0));
  s.join();
  EXPECT_LT(s.error([](int x, int y) { return x > 8 && y > 8 && x < width - 8 && y < height - 8; }),
            0.35 * sigma * sigma);
}

/// A texture as fine as the pixels is lost when it is sampled between them. Its error changes sign from pixel to pixel
/// and may be below the noise of each pixel. The joined frame must not be worse than the single frame, however strong
/// the texture is.
TEST(JoinNeighbours, FineTextureIsNoWorseThanTheFrameAlone) {
  for (const double strength : {0.25, 0.5, 1.0, 2.0, 4.0, 16.0}) {
    const Truth fine = [&](int frame, int x, int y) {
      return 3 + strength * sigma * std::sin(2.3 * (x - 1.3 * frame)) * std::cos(2.1 * (y - 0.4 * frame));
    };
    Sequence s(fine, motion_of(1.3, 0.4));
    const auto inner = [](int x, int y) { return x > 8 && y > 8 && x < width - 8 && y < height - 8; };
    const double before = s.error(inner);
    s.join();
    EXPECT_LT(s.error(inner), 1.02 * before) << strength;
  }
}

TEST(JoinNeighbours, NothingCrossesACut) {
  Sequence s([](int frame, int x, int y) { return frame < 0 ? 0.5 * texture(y, x) : texture(x, y); }, Image());
  s.neighbours.resize(2);  // the frames before the cut
  const HalfPair before = s.pair;
  EXPECT_LT(s.join().weight, 1e-3);
  EXPECT_LT(s.error(), 1.001 * sigma * sigma);
}

/// A bright spot runs over a still picture, which has no vectors for it: along its way the joined frame is no worse.
TEST(JoinNeighbours, AMovingHighlightLeavesNoTrail) {
  const auto spot = [](int frame, int x, int y) { return std::hypot(x - 32 - 4 * frame, y - 24) < 4; };
  Sequence s([&](int frame, int x, int y) { return 1 + (spot(frame, x, y) ? 1.0 : 0.0); }, Image());
  const auto way = [](int x, int y) { return std::abs(x - 32) < 14 && std::abs(y - 24) < 6; };
  const double before = s.error(way);
  s.join();
  EXPECT_LT(s.error(way), before);
  // Places that the spot has left keep the radiance of the current frame.
  double trail = 0, count = 0;
  for (int y = 21; y < 28; ++y)
    for (const int x : {24, 25, 39, 40})
      for (const Image& half : s.pair.color) trail += static_cast<double>(half.at(x, y, 0)) - 1, ++count;
  EXPECT_LT(std::abs(trail / count), 4 * sigma / std::sqrt(count));
}

/// Radiance that grows by a third of the noise in each frame: the changes before and after cancel.
TEST(JoinNeighbours, SteadyChangeCancelsOut) {
  Sequence s([](int frame, int x, int y) { return texture(x, y) + 0.03 * frame; }, Image());
  const JoinCounts counts = s.join();
  EXPECT_GT(counts.weight, 3);
  double bias = 0;
  for (std::size_t i = 0; i < s.truth.pixels(); ++i)
    bias += static_cast<double>(s.pair.color[0].plane(0)[i]) - static_cast<double>(s.truth.plane(0)[i]);
  bias /= static_cast<double>(s.truth.pixels());
  EXPECT_LT(std::abs(bias), 4 * sigma / std::sqrt(static_cast<double>(s.truth.pixels())));
}

/// A renderer that starts every frame with the same random numbers makes the same noise in all: there is no gain, and
/// the stated variance must not shrink.
TEST(JoinNeighbours, SharedNoiseIsNotTakenForIndependent) {
  Sequence s([](int, int x, int y) { return texture(x, y); }, Image());
  for (Neighbour& frame : s.frames) frame.pair.color = s.pair.color;
  s.join();
  EXPECT_GT(s.claimed(), 0.9 * sigma * sigma);
}

/// Halves that were split from one image: `noise` is that of the image, and the split adds its own.
HalfPair split_pair(const Image& truth, std::uint64_t noise, std::uint64_t split) {
  const HalfPair of_image = test::pair_of(truth, sigma / std::sqrt(2.0), noise);
  const HalfPair of_split = test::pair_of(Image(truth.width(), truth.height(), 3), sigma / std::sqrt(2.0), split);
  HalfPair out = test::pair_of(truth, sigma, 1);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < truth.pixels(); ++i) {
      const Real mean = of_image.color[0].plane(c)[i], difference = of_split.color[0].plane(c)[i];
      out.color[0].plane(c)[i] = mean + difference;
      out.color[1].plane(c)[i] = mean - difference;
    }
  return out;
}

/// Frames of one seed that were split with random numbers of their own: their average would lose the noise of the split
/// alone, and the difference of its halves would no longer show the noise that is left. Where noise is shared
/// neighbours bring nothing, elsewhere they help as ever.
TEST(JoinNeighbours, SharedNoiseIsFoundInSplitHalves) {
  const Truth still = [](int, int x, int y) { return texture(x, y); };
  for (const double part : {1.0, 0.5}) {  // of the columns that share their noise
    Sequence s(still, Image());
    const auto shares = [&](int x) { return x < part * width; };
    s.pair = split_pair(s.truth, 1, 2);
    for (std::size_t k = 0; k < s.frames.size(); ++k) {
      s.frames[k].pair = split_pair(s.truth, 1, 10 + k);
      const HalfPair other = split_pair(s.truth, 20 + k, 30 + k);
      for (std::size_t h = 0; h < 2; ++h)
        for (int c = 0; c < 3; ++c)
          for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
              if (!shares(x)) s.frames[k].pair.color[h].at(x, y, c) = other.color[h].at(x, y, c);
    }
    const HalfPair before = s.pair;
    const JoinCounts counts = s.join();
    const double border = part < 1 ? 24.0 / width : 0;  // it is found in blocks of 16 pixels and those around them
    EXPECT_NEAR(counts.shared_noise, part, border);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < static_cast<int>(part * width) - 24; ++x)
        EXPECT_EQ(s.pair.color[0].at(x, y, 0), before.color[0].at(x, y, 0)) << x << " " << y;
    if (part < 1) {
      EXPECT_LT(s.error([](int x, int) { return x > width - 8; }), 0.4 * sigma * sigma);
    } else {
      EXPECT_NEAR(s.claimed(), sigma * sigma, 1e-5);
    }
  }
}

/// Frames of which a part of the samples has one seed, as where a render goes on from another one of less samples, or
/// under another exposure: their noise correlates, and neighbours bring nothing.
TEST(JoinNeighbours, NoiseThatIsSharedInPartIsFound) {
  for (const double exposure : {1.0, 1.6}) {
    Sequence s([](int, int x, int y) { return 1 + 0.3 * std::sin(0.3 * x) * std::cos(0.2 * y); }, Image());
    s.pair = split_pair(s.truth, 1, 2);
    for (std::size_t k = 0; k < s.frames.size(); ++k) {
      HalfPair& frame = s.frames[k].pair;
      frame = split_pair(s.truth, 20 + k, 10 + k);
      // rho is 1 / sqrt 2: the frame has half as many samples, all of which the current one has too.
      for (std::size_t h = 0; h < 2; ++h)
        for (int c = 0; c < 3; ++c)
          for (std::size_t i = 0; i < s.truth.pixels(); ++i) {
            const Real mine = (s.pair.color[0].plane(c)[i] + s.pair.color[1].plane(c)[i]) / 2;
            Real& other = frame.color[h].plane(c)[i];
            other = static_cast<Real>(exposure) * (mine + other - s.truth.plane(c)[i]);
          }
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < s.truth.pixels(); ++i)
          frame.variance.plane(c)[i] *= static_cast<Real>(1.5 * exposure * exposure);
    }
    EXPECT_GT(s.join().shared_noise, 0.95);
    EXPECT_LT(s.claimed(), 1.05 * sigma * sigma);
    EXPECT_GT(s.claimed(), 0.9 * sigma * sigma);
  }
}

/// Frames with seeds of their own are not taken for ones that share their noise.
TEST(JoinNeighbours, IndependentNoiseIsNotTakenForShared) {
  Sequence s([](int, int x, int y) { return texture(x, y); }, Image());
  EXPECT_LT(s.join().shared_noise, 0.001);
}

/// Stripes that move without vectors, fainter than the noise of a pixel, so that the radiance does not show it. The
/// albedo of both frames does.
TEST(JoinNeighbours, AlbedoThatDiffersKeepsNeighboursOut) {
  const auto stripe = [](int frame, int x) { return (x - 2 * frame) / 4 % 2 == 0 ? 1.0 : 0.92; };
  const Truth moving = [&](int frame, int x, int) { return stripe(frame, x); };
  Sequence with(moving, Image()), without(moving, Image());
  with.show(Surface::Color, 3, [&](int k, int x, int, int) { return stripe(k, x); });
  with.join();
  without.join();
  const auto bias = [](const Sequence& s) {  // of the mean of each column, as the stripes are columns
    double sum = 0;
    for (int x = 8; x < width - 8; ++x) {
      double column = 0;
      for (int y = 0; y < height; ++y)
        column += static_cast<double>(s.pair.color[0].at(x, y, 0)) - static_cast<double>(s.truth.at(x, y, 0));
      sum += column / height * column / height;
    }
    return sum / (width - 16);
  };
  EXPECT_GT(bias(without), 2 * bias(with));
  EXPECT_LT(bias(with), 1.3 * sigma * sigma / height);  // that of the frame alone
}

/// Surfaces that agree lower no weight, and neither does their noise where it is known.
TEST(JoinNeighbours, SurfacesThatAgreeKeepTheGain) {
  const Truth still = [](int, int x, int y) { return texture(x, y); };
  Sequence s(still, Image());
  const double noise = 0.05;
  std::array<HalfPair, 5> noisy;
  for (std::size_t k = 0; k < noisy.size(); ++k) noisy[k] = test::pair_of(s.truth, noise, 60 + k);
  s.show(Surface::Color, 3, [&](int k, int x, int y, int c) {
    return static_cast<double>(noisy[static_cast<std::size_t>(k + 2)].color[0].at(x, y, c));
  });
  s.show(Surface::Direction, 3, [](int, int, int, int c) { return c == 2 ? 1.0 : 0.0; });
  s.show(Surface::Distance, 1, [](int k, int x, int, int) { return std::log(2.0 + 0.1 * x + 0.05 * k); });
  s.noise[index_of(Surface::Color)] = Image(width, height, 1, static_cast<Real>(3 * noise * noise));
  EXPECT_GT(s.join().weight, 3);
  EXPECT_LT(s.error(), 0.27 * sigma * sigma);
}

/// An object that covers the picture in the other frames, of the same radiance: its depth or its normal differs.
TEST(JoinNeighbours, ADepthOrANormalThatDiffersKeepsNeighboursOut) {
  const Truth still = [](int, int x, int y) { return texture(x, y); };
  Sequence depth(still, Image()), normal(still, Image());
  depth.show(Surface::Distance, 1, [](int k, int, int, int) { return std::log(k == 0 ? 5.0 : 3.0); });
  normal.show(Surface::Direction, 3, [](int k, int, int, int c) { return c == (k == 0 ? 2 : 0) ? 1.0 : 0.0; });
  EXPECT_LT(depth.join().weight, 0.02);
  EXPECT_LT(normal.join().weight, 0.02);
}

/// Data windows that move, as those of renderers that crop to what they hit: pixels of the same coordinates in the file
/// are joined, and those that a neighbour lacks stay.
TEST(JoinNeighbours, FramesOfOtherWindowsJoinByTheCoordinatesOfTheFile) {
  const Truth still = [](int, int x, int y) { return texture(x, y); };
  for (const bool vectors : {false, true}) {
    Sequence s(still, vectors ? motion_of(0, 0) : Image(), 1);
    const Rect window{12, -7, width + 12, height - 9};  // another size too
    for (std::size_t k = 0; k < s.frames.size(); ++k) {
      const Image truth = test::image_of(window.width(), window.height(), 3, [&](int x, int y, int c) {
        return (1 + 0.2 * c) * texture(x + window.x0, y + window.y0);
      });
      s.frames[k].pair = test::pair_of(truth, sigma, 70 + k);
      s.frames[k].geometry.window = window;
      if (vectors) s.frames[k].geometry.motion = Image(window.width(), window.height(), 4);
    }
    const HalfPair before = s.pair;
    s.join(1);
    EXPECT_LT(s.error([&](int x, int y) { return window.contains(x, y); }), 0.5 * sigma * sigma);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (!window.contains(x, y)) {
          EXPECT_EQ(s.pair.color[0].at(x, y, 0), before.color[0].at(x, y, 0));
        }
  }
}

/// Weights depend on the noise: a neighbour with a hundredth of the variance counts more than the frame itself, a very
/// noisy one hardly at all.
TEST(JoinNeighbours, WeightsFollowTheVariance) {
  for (const double noise : {0.1 * sigma, 10 * sigma}) {
    Sequence s([](int, int x, int y) { return texture(x, y); }, Image(), 1);
    for (std::size_t k = 0; k < s.frames.size(); ++k) s.frames[k].pair = test::pair_of(s.truth, noise, 50 + k);
    const double weight = s.join(1).weight;
    EXPECT_TRUE(noise < sigma ? weight > 3.5 : weight < 0.05) << weight;
    EXPECT_LT(s.error(), 1.02 * sigma * sigma);
  }
}

TEST(JoinNeighbours, LayersThatAddUpStillDo) {
  Sequence s([](int frame, int x, int y) { return texture(x - frame, y); }, motion_of(1, 0));
  const auto split = [](HalfPair& pair) {
    for (Image& color : pair.color) {
      Image all(width, height, 9);
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < color.pixels(); ++i) {
          const Real value = color.plane(c)[i], part = value * Real(0.3) + Real(0.001) * static_cast<Real>(i % 7);
          all.plane(c)[i] = value;
          all.plane(3 + c)[i] = part;
          all.plane(6 + c)[i] = value - part;
        }
      color = all;
    }
  };
  split(s.pair);
  for (Neighbour& frame : s.frames) split(frame.pair);
  ASSERT_GT(s.join().weight, 2);
  for (const Image& half : s.pair.color)
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < half.pixels(); ++i)
        ASSERT_NEAR(half.plane(3 + c)[i] + half.plane(6 + c)[i], half.plane(c)[i], 1e-5);
}

TEST(JoinNeighbours, PixelsWithoutNoiseStay) {
  Sequence s([](int, int x, int y) { return texture(x, y); }, Image());
  for (int c = 0; c < 3; ++c) s.pair.variance.at(5, 6, c) = 0;
  const HalfPair before = s.pair;
  s.join();
  for (std::size_t h = 0; h < 2; ++h)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(s.pair.color[h].at(5, 6, c), before.color[h].at(5, 6, c));
}

TEST(JoinNeighbours, OtherLayersAndGapsAreLeftOut) {
  Sequence s([](int, int x, int y) { return texture(x, y); }, Image());
  s.neighbours.erase(s.neighbours.begin() + 1);  // -1: so that -2 has no way to this frame
  s.frames[3].pair = test::pair_of(Image(width, height, 6, 1), sigma, 9);
  EXPECT_EQ(s.join().neighbours, 1u);
  s.neighbours.clear();
  EXPECT_EQ(s.join().neighbours, 0u);
}

/// Frames are processed in bands of rows: a part of a picture has the same bits, except near the cut.
TEST(JoinNeighbours, BandsDoNotShow) {
  const Truth still = [](int, int x, int y) { return texture(x, y); };
  Sequence tall(still, Image(), 1, 420), cut = tall;
  const Rect top{0, 0, width, 350};
  cut.pair = crop(tall.pair, top);
  cut.geometry.window = top;
  for (std::size_t k = 0; k < cut.frames.size(); ++k) {
    cut.frames[k].pair = crop(tall.frames[k].pair, top);
    cut.frames[k].geometry.window = top;
    cut.neighbours[k].frame = &cut.frames[k];
  }
  tall.join(1);
  cut.join(1);
  const Rect same{0, 0, width, 300};
  for (std::size_t h = 0; h < 2; ++h)
    EXPECT_TRUE(test::same_bits(crop(tall.pair.color[h], same), crop(cut.pair.color[h], same)));
  EXPECT_TRUE(test::same_bits(crop(tall.pair.variance, same), crop(cut.pair.variance, same)));
}

/// A point that a nearer object covers in the other frame is not seen: the vectors there lead elsewhere.
TEST(Follow, HiddenPointsAreNotSeen) {
  HalfPair pair = test::pair_of(Image(width, height, 3, 1), sigma, 1);
  const Geometry still{{0, 0, width, height}, motion_of(0, 0), {}};
  Neighbour next{pair, still};
  const auto covered = [](int x, int y) { return x >= 20 && x < 30 && y >= 10 && y < 20; };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (covered(x, y)) next.geometry.motion.at(x, y, 0) = -10;  // the cover came from 10 pixels to the left
  const std::vector<Places> places = follow(still, pair, {{1, &next}});
  ASSERT_EQ(places.size(), 1u);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      EXPECT_EQ(places[0].seen[pair.variance.index(x, y)], covered(x, y) ? 0 : 1) << x << " " << y;
}

/// Renders without variance or halves are split with random numbers; those of two frames must not be the same, or their
/// halves would not be independent.
TEST(PrepareNeighbour, SplitsEveryFrameWithOtherRandomNumbers) {
  Frame frame = test::make_scene(40, 32, 0.2, 3).frame;
  frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = Image();
  const Params params;
  const auto difference = [&](int number) {
    const Neighbour n = *prepare_neighbour(frame, number, params, silent_progress());
    std::vector<double> out;
    for (std::size_t i = 0; i < n.pair.variance.pixels(); ++i)
      out.push_back(static_cast<double>(n.pair.color[0].plane(0)[i]) -
                    static_cast<double>(n.pair.color[1].plane(0)[i]));
    return out;
  };
  const auto correlation = [](const std::vector<double>& a, const std::vector<double>& b) {
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) ab += a[i] * b[i], aa += a[i] * a[i], bb += b[i] * b[i];
    return ab / std::sqrt(aa * bb);
  };
  EXPECT_EQ(difference(4), difference(4));
  // 1280 pixels: independent ones correlate by less than 5 / sqrt(1280).
  EXPECT_LT(std::abs(correlation(difference(4), difference(5))), 0.14);
  EXPECT_LT(std::abs(correlation(difference(-1), difference(1))), 0.14);
}

TEST(Reconstruct, NeighboursInTimeLowerTheError) {
  const test::Scene scene = test::make_scene(80, 64, 0.5, 1);
  Params params;
  params.temporal.radius = 1;
  const Neighbour before = *prepare_neighbour(test::make_scene(80, 64, 0.5, 2).frame, 1, params, silent_progress());
  const Neighbour after = *prepare_neighbour(test::make_scene(80, 64, 0.5, 3).frame, 3, params, silent_progress());
  Frame once = scene.frame, again = scene.frame;
  const Result alone = reconstruct(once, params, silent_progress());
  const Result joined = reconstruct(again, {{-1, &before}, {1, &after}}, params, silent_progress());
  EXPECT_EQ(joined.report.neighbours, 2u);
  EXPECT_LT(test::relative_mse(joined.beauty, scene.truth), 0.8 * test::relative_mse(alone.beauty, scene.truth));
  EXPECT_LT(joined.report.estimated_relative_mse, alone.report.estimated_relative_mse);
  // The energy is that of the current frame.
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(joined.report.energy_after[c] / joined.report.energy_before[c], 1, 1e-5);
}

}  // namespace
}  // namespace polyrecon
