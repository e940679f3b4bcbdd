// What the user names and cannot be used as it is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "io/inspect.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::join;
using testing::layer;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

std::string write(const TemporaryFolder& folder, const std::vector<testing::TestChannel>& channels) {
  TestPart part;
  part.channels = channels;
  return write_exr(folder / "in.exr", {part});
}

TEST(Requests, OneChannelOfAColorIsNoLayerToBeDenoised) {
  const TemporaryFolder folder;
  const std::string path = write(folder, join({layer("", "RGB"), layer("light", "RGB"), layer("mist", "Z")}));
  ReadOptions options;
  options.aovs = {"light.R"};
  const Error error = error_of([&] { read_frame_header(path, options); });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("light.R is one channel of layer light; --aov light denoises all of them"));
  options.aovs = {"mist.Z"};
  EXPECT_EQ(read_frame(path, options).frame.aovs.size(), 1U);
}

TEST(Requests, OneHalfThatIsNamedAloneIsNoted) {
  const TemporaryFolder folder;
  auto beauty = layer("", "RGB");
  for (int c = 0; c < 3; ++c)
    beauty[static_cast<std::size_t>(c)].samples = [c](int x, int y) {
      return (testing::pattern(c)(x, y) + testing::pattern(7 + c)(x, y)) / 2;
    };
  const std::string path = write(folder, join({beauty, layer("one", "RGB"), layer("two", "RGB", 7)}));
  ReadOptions options;
  options.map = {parse_mapping("half-a=one")};
  const ReadResult alone = read_frame(path, options);
  EXPECT_FALSE(alone.frame.beauty.has_halves());
  EXPECT_THAT(alone.notes, ElementsAre(HasSubstr("one is not used: it is one half without the other, which --map "
                                                 "half-b=LAYER names")));
  options.map.push_back(parse_mapping("half-b=two"));
  const ReadResult both = read_frame(path, options);
  EXPECT_EQ(static_cast<double>(both.frame.beauty.half_b.at(1, 2, 0)), testing::pattern(7)(1, 2));
  EXPECT_THAT(both.notes, IsEmpty());
}

TEST(Requests, AResultThatIsDenoisedAgainIsNoted) {
  const TemporaryFolder folder;
  const std::string path = write(folder, layer("", "RGB"));
  const ReadResult read = read_frame(path);
  EXPECT_THAT(read.notes, IsEmpty());
  WriteOptions options;
  options.provenance.settings = "--quality draft";
  const std::vector<Replacement> result{{read.frame.beauty.name, read.frame.beauty.mean, false, {}}};
  write_result(read.source, result, folder / "out.exr", options);
  EXPECT_THAT(inspect(folder / "out.exr").notes, Contains(HasSubstr("holds a result of this program")));
  options.keep_noisy = true;
  write_result(read.source, result, folder / "kept.exr", options);
  EXPECT_THAT(inspect(folder / "kept.exr").notes, Not(Contains(HasSubstr("holds a result of this program"))));
}

TEST(Requests, LayersOfEachViewLayerAreDenoisedWhereTheyBelongWithoutANote) {
  const TemporaryFolder folder;
  const std::string path = write(folder, join({layer("a.Combined", "RGB"), layer("a.key", "RGB", 10),
                                               layer("b.Combined", "RGB", 20), layer("b.fill", "RGB", 30)}));
  ReadOptions options;
  options.aovs = {"a.key", "b.fill"};
  for (const auto& [view_layer, aov] : {std::pair("a", "a.key"), std::pair("b", "b.fill")}) {
    options.picture = LayerView{view_layer, ""};
    const ReadResult read = read_frame(path, options);
    ASSERT_EQ(read.frame.aovs.size(), 1U);
    EXPECT_EQ(read.frame.aovs[0].name, aov);
    EXPECT_THAT(read.notes, IsEmpty());
  }
}

}  // namespace
}  // namespace polyrecon
