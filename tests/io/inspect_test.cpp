#include "io/inspect.h"

#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
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
  const LayerStatistics* found = inspection.statistics_of(layer_name);
  if (!found) throw std::runtime_error("no statistics of " + layer_name);
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

TEST(InspectFile, RolesThatTheRendererHasNoNameForAreNotMissing) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = flat_layer("Ci", "RGB", 1);  // RenderMan has no visibility
  EXPECT_THAT(inspect(write_exr(folder / "a.exr", {part})).missing,
              ElementsAre("normal", "albedo", "depth", "sample-count", "variance", "half buffers"));
  ReadOptions options;
  options.map = {parse_mapping("beauty=colours")};
  part.channels = flat_layer("colours", "RGB", 1);
  EXPECT_THAT(inspect(write_exr(folder / "b.exr", {part}), options).missing, Contains("visibility"));
}

TEST(InspectFile, NoiseLevelFromVarianceOrHalves) {
  // 0.5 / (0.3^2 + 0.01) = 5. Halves 1 and 3 alone: mean 0.3 stays, (2^2 / 4) / 0.1 = 10.
  const TemporaryFolder folder;
  TestPart part;
  part.channels = join({flat_layer("V.Combined", "RGB", 0.3), flat_layer("V.Combined Variance", "RGB", 0.5)});
  part.edit = testing::with_text("cycles.V.samples", "8");
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

/// Bytes that this process has read from files, as Linux counts them.
long long bytes_read() {
  std::ifstream counts("/proc/self/io");
  std::string key;
  long long value = -1;
  counts >> key >> value;
  return key == "rchar:" ? value : -1;
}

TEST(InspectFile, DecodesEachPartOnce) {
  if (bytes_read() < 0) GTEST_SKIP() << "/proc/self/io cannot be read";
  const TemporaryFolder folder;
  TestPart beauty, other;
  for (TestPart* part : {&beauty, &other}) {
    part->window = part->display = {0, 0, 256, 256};
    part->compression = Imf::NO_COMPRESSION;
  }
  beauty.channels =
      join({flat_layer("V.Combined", "RGB", 1), layer("V.Combined Variance", "RGB"), layer("V.X", "XYZ")});
  beauty.name = "a";
  other.channels = layer("V.Cryptomatte00", "RGBA");
  other.name = "b";
  const std::string path = write_exr(folder / "a.exr", {beauty, other});
  inspect(path);  // the first use of TBB reads files of the system
  const long long before = bytes_read();
  const Inspection inspection = inspect(path);
  const long long size = static_cast<long long>(std::filesystem::file_size(path));
  EXPECT_LT(bytes_read() - before, size + size / 10);
  ASSERT_TRUE(inspection.frame);
  EXPECT_FALSE(inspection.frame->beauty.variance.empty());
  EXPECT_EQ(inspection.frame->beauty.mean.at(200, 100, 1), 1);
  for (const char* name : {"V.Combined", "V.Combined Variance", "V.X", "V.Cryptomatte00"})
    EXPECT_EQ(of(inspection, name).pixels, 256u * 256u) << name;
  EXPECT_EQ(of(inspection, "V.Cryptomatte00").maximum, 60);  // of the pattern
}

TEST(InspectFile, AFileWithoutABeautyIsDescribedToo) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("V.Something", "XYZ");
  const Inspection inspection = inspect(write_exr(folder / "a.exr", {part}));
  EXPECT_FALSE(inspection.frame);
  EXPECT_THAT(inspection.missing, Contains("beauty"));
  EXPECT_THAT(inspection.notes, Contains(HasSubstr("no beauty")));
  EXPECT_EQ(of(inspection, "V.Something").nan, 0u);
  EXPECT_EQ(testing::error_of([&] { inspect(folder / "none.exr"); }).code(), ExitCode::Missing);
}

}  // namespace
}  // namespace polyrecon
