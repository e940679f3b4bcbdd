#include "io/inspect.h"

#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "io/exr_fixture.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::flat_layer;
using ::testing::HasSubstr;
using testing::join;
using testing::layer;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

const LayerStatistics& of(const Inspection& inspection, const std::string& layer_name) {
  const auto found = std::find_if(inspection.statistics.begin(), inspection.statistics.end(),
                                  [&](const LayerStatistics& s) { return s.layer == layer_name; });
  if (found == inspection.statistics.end()) throw std::runtime_error("no statistics of " + layer_name);
  return *found;
}

TEST(InspectFile, CountsWhatIsWrongWithALayer) {
  const TemporaryFolder folder;
  TestPart part;  // 8 x 6
  part.channels = flat_layer("V.Combined", "RGB", 1);
  part.channels[0].samples = [](int x, int y) {
    if (y == 0) return std::numeric_limits<double>::quiet_NaN();
    return y == 1 ? std::numeric_limits<double>::infinity() : x == 0 ? -2.0 : 4.0;
  };
  part.channels[1].samples = [](int, int y) { return y == 0 ? -std::numeric_limits<double>::infinity() : 1.0; };
  const Inspection inspection = inspect(write_exr(folder / "a.exr", {part}));
  const LayerStatistics& s = of(inspection, "V.Combined");
  EXPECT_EQ(s.pixels, 48u);
  EXPECT_EQ(s.nan, 8u);
  EXPECT_EQ(s.infinite, 16u);
  EXPECT_EQ(s.negative, 12u);  // -Inf in the first row, -2 in the first column of four others
  EXPECT_EQ(s.minimum, -2);
  EXPECT_EQ(s.maximum, 4);
  // Finite: R has 4 of -2 and 28 of 4, G 40 of 1, B 48 of 1: (104 + 88) / 120.
  EXPECT_DOUBLE_EQ(s.mean, 192.0 / 120);
  EXPECT_EQ(inspection.noise_level, -1);
  EXPECT_THAT(inspection.missing,
              ElementsAre("normal", "albedo", "depth", "visibility", "sample-count", "variance", "half buffers"));
}

TEST(InspectFile, NoiseLevelFromVarianceOrHalves) {
  // 0.5 / (0.3^2 + 0.01) = 5. Halves 1 and 3 alone: mean 0.3 stays, (2^2 / 4) / 0.1 = 10.
  const TemporaryFolder folder;
  TestPart part;
  part.channels = join({flat_layer("V.Combined", "RGB", 0.3), flat_layer("V.Combined Variance", "RGB", 0.5)});
  part.edit = [](Imf::Header& header) { header.insert("cycles.V.samples", Imf::StringAttribute("8")); };
  const Inspection with_variance = inspect(write_exr(folder / "a.exr", {part}));
  EXPECT_NEAR(with_variance.noise_level, 5, 1e-5);  // 0.3 is no float
  EXPECT_EQ(with_variance.samples, 8);
  EXPECT_THAT(with_variance.missing, Not(Contains("variance")));
  part.channels = join({flat_layer("V.Combined", "RGB", 0.3), flat_layer("V.Combined A", "RGB", 1),
                        flat_layer("V.Combined B", "RGB", 3)});
  const Inspection with_halves = inspect(write_exr(folder / "b.exr", {part}));
  EXPECT_NEAR(with_halves.noise_level, 10, 1e-5);
  EXPECT_THAT(with_halves.missing, Contains("variance"));
  EXPECT_THAT(with_halves.missing, Not(Contains("half buffers")));
}

TEST(InspectFile, AFileWithoutABeautyIsDescribedToo) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("V.Something", "XYZ");
  const Inspection inspection = inspect(write_exr(folder / "a.exr", {part}));
  EXPECT_THAT(inspection.missing, Contains("beauty"));
  EXPECT_THAT(inspection.notes, Contains(HasSubstr("no beauty")));
  EXPECT_EQ(of(inspection, "V.Something").nan, 0u);
  EXPECT_EQ(testing::error_of([&] { inspect(folder / "none.exr"); }).code(), ExitCode::Missing);
}

}  // namespace
}  // namespace polyrecon
