#include "regression/window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/simd.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

TEST(BasisLayout, CountsColumnsOfEveryNestedModel) {
  // Terms of order o: o + 1. Order 4: 2 + 3 + 4 + 5 = 14.
  const BasisLayout layout(8, 4);
  const int expected[] = {1, 9, 11, 14, 18, 23}, order[] = {0, 0, 1, 2, 3, 4};
  ASSERT_EQ(layout.models(), 6);
  for (int model = 0; model < 6; ++model) {
    EXPECT_EQ(layout.columns(model), expected[model]);
    EXPECT_EQ(BasisLayout::order_of(model), order[model]);
  }
  EXPECT_EQ(layout.columns(), 23);
  EXPECT_EQ(BasisLayout(BasisLayout::max_features, BasisLayout::max_order).columns(), BasisLayout::max_columns);
  EXPECT_EQ(BasisLayout(BasisLayout::max_features, BasisLayout::max_order).models(), BasisLayout::max_models);
}

/// Checks every column of a window of radius r around (cx, cy), cut by the image's border, against the definition.
void check_columns(int order, int cx, int cy, int radius) {
  SCOPED_TRACE(testing::Message() << "order " << order << " at " << cx << ", " << cy);
  test::Random random(5);
  const int width = 9, height = 7;
  const auto noise = [&](int, int, int) { return random.normal(); };
  const Image response = image_of(width, height, 6, noise), variance = image_of(width, height, 3, noise);
  const Image features = image_of(width, height, 2, noise), guess = image_of(width, height, 3, noise);
  const BasisLayout layout(2, order);
  Window window;
  window.reserve(radius, layout.columns(), 6);
  window.count = 0;
  for (int y = std::max(cy - radius, 0); y <= std::min(cy + radius, height - 1); ++y)
    for (int x = std::max(cx - radius, 0); x <= std::min(cx + radius, width - 1); ++x, ++window.count) {
      window.x[static_cast<std::size_t>(window.count)] = x;
      window.y[static_cast<std::size_t>(window.count)] = y;
    }
  gather({&response, &variance, &features, &guess}, layout, cx, cy, radius, window);
  EXPECT_EQ(window.padded % Window::lanes, 0);
  EXPECT_LE(window.padded, window.stride);
  const auto column = [&](const std::vector<Real>& values, int c, int j) {
    return static_cast<double>(values[static_cast<std::size_t>(c * window.stride + j)]);
  };
  const auto design = [&](int c, int j) { return window.design[static_cast<std::size_t>(j * window.pitch + c)]; };
  for (int j = 0; j < window.padded; ++j) {
    const int x = window.x[static_cast<std::size_t>(j)], y = window.y[static_cast<std::size_t>(j)];
    if (j >= window.count) {
      EXPECT_EQ(x, cx);
      EXPECT_EQ(y, cy);
    }
    EXPECT_EQ(design(0, j), 1);
    int c = 1;
    for (int f = 0; f < 2; ++f, ++c)
      EXPECT_EQ(design(c, j), static_cast<double>(features.at(x, y, f) - features.at(cx, cy, f)));
    const double dx = static_cast<double>(x - cx) / radius, dy = static_cast<double>(y - cy) / radius;
    for (int o = 1; o <= order; ++o)
      for (int b = 0; b <= o; ++b, ++c)
        EXPECT_NEAR(design(c, j), std::pow(dx, o - b) * std::pow(dy, b), 1e-6) << "dx^" << o - b << " dy^" << b;
    EXPECT_EQ(c, window.layout.columns());
    for (; c % vector_lanes != 0; ++c) EXPECT_EQ(design(c, j), 0);
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(window.origin[static_cast<std::size_t>(k)], response.at(cx, cy, k));
      EXPECT_EQ(column(window.response, k, j), static_cast<double>(response.at(x, y, k) - response.at(cx, cy, k)));
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(column(window.noise_variance, k, j), static_cast<double>(variance.at(x, y, k)));
      EXPECT_EQ(column(window.guess, k, j), static_cast<double>(guess.at(x, y, k) - guess.at(cx, cy, k)));
    }
  }
}

TEST(Gather, ColumnsAreThoseOfEquation2) {
  for (int order = 0; order <= 4; ++order) {
    check_columns(order, 4, 3, 3);  // cut nowhere
    check_columns(order, 0, 0, 3);  // in a corner
    check_columns(order, 8, 5, 2);  // at a border
    check_columns(order, 4, 3, 1);
  }
}

TEST(Gather, AFeatureThatVariesByRoundingAloneHasNoColumn) {
  const Image plain(5, 5, 3);
  for (const auto& [size, columns] : {std::pair{1e-7, 1}, std::pair{1e-4, 1}, std::pair{1e-3, 2}}) {
    test::Random random(6);
    const double variation = size;
    const Image feature = image_of(5, 5, 1, [&](int, int, int) { return 0.5 + variation * random.uniform(-1, 1); });
    Window window;
    window.reserve(2, 2, 3);
    window.count = 25;
    for (int j = 0; j < 25; ++j) {
      window.x[static_cast<std::size_t>(j)] = j % 5;
      window.y[static_cast<std::size_t>(j)] = j / 5;
    }
    gather({&plain, &plain, &feature, nullptr}, BasisLayout(1, 0), 2, 2, 2, window);
    EXPECT_EQ(window.layout.columns(), columns) << size;
  }
}

TEST(Gather, AFeatureThatDoesNotVaryOverTheWindowHasNoColumn) {
  // Of three features the second is 5 inside the window and 6 elsewhere.
  const Image response(9, 9, 3), variance(9, 9, 3);
  const Image features = test::image_of(9, 9, 3, [](int x, int y, int c) {
    return c == 1 ? (std::max(std::abs(x - 4), std::abs(y - 4)) > 1 ? 6 : 5) : x + 10 * y + c;
  });
  Window window;
  const BasisLayout layout(3, 1);
  window.reserve(2, layout.columns(), 3);
  for (const int radius : {1, 2}) {
    window.count = 0;
    for (int y = 4 - radius; y <= 4 + radius; ++y)
      for (int x = 4 - radius; x <= 4 + radius; ++x, ++window.count) {
        window.x[static_cast<std::size_t>(window.count)] = x;
        window.y[static_cast<std::size_t>(window.count)] = y;
      }
    gather({&response, &variance, &features, nullptr}, layout, 4, 4, radius, window);
    EXPECT_EQ(window.layout.features(), radius == 1 ? 2 : 3);
    EXPECT_EQ(window.layout.order(), 1);
    // The column after the last feature is dx / radius: -1 at the window's first pixel.
    EXPECT_EQ(window.design[static_cast<std::size_t>(window.layout.columns(1))], -1);
  }
}

}  // namespace
}  // namespace polyrecon
