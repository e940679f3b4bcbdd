// Renders of one frame with different seeds, whose first sample Cycles takes at the pixel's centre in each of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using testing::flat_layer;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

enum class Depth { None, Equal, OfLaterSamples, Sky };

TestPart render(int seed, const std::string& samples, Depth depth) {
  TestPart part;
  part.channels = testing::join({testing::layer("V.Combined", "RGB", seed), flat_layer("V.Denoising Depth", "Z", 5)});
  const double first = depth == Depth::Sky || (depth == Depth::OfLaterSamples && seed > 0) ? 1e10 : 7;
  if (depth != Depth::None) part.channels.push_back({"V.Depth.Z", Imf::FLOAT, testing::constant(first)});
  if (!samples.empty()) part.edit = testing::with_text("cycles.V.samples", samples);
  return part;
}

std::vector<std::string> notes_of(int renders, const std::string& samples, Depth depth, double by_hand = 0) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts;
  for (int seed = 0; seed < renders; ++seed) parts.push_back(render(seed, samples, depth));
  MergeOptions options;
  options.samples = by_hand;
  return merge(testing::write_all(folder, parts), folder / "out.exr", options).notes;
}

const auto certain = HasSubstr("V: the first of the 4 samples of each of the 4 renders lies at the pixel's centre");
const auto alike = HasSubstr("their errors are alike");

TEST(SharedSamples, ShortRendersOfOtherSeedsAreNoted) {
  EXPECT_THAT(notes_of(4, "4", Depth::Equal), Contains(certain));
  EXPECT_THAT(notes_of(4, "4", Depth::Equal), Contains(HasSubstr("fewer and longer renders have less error")));
  EXPECT_THAT(notes_of(4, "4", Depth::Equal), Not(Contains(HasSubstr("give --samples"))));
  EXPECT_THAT(notes_of(4, "4", Depth::OfLaterSamples), Contains(HasSubstr("give --samples")));
}

/// Whoever denoises the merged file hears of it too.
TEST(SharedSamples, TheMergedFileRepeatsTheNote) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  for (int seed = 0; seed < 4; ++seed)
    paths.push_back(write_exr(folder / std::to_string(seed), {render(seed, "4", Depth::Equal)}));
  merge(paths, folder / "out.exr");
  EXPECT_THAT(read_frame_header(folder / "out.exr").notes, Contains(certain));
  EXPECT_THAT(read_frame_header(paths[0]).notes, Not(Contains(alike)));
}

TEST(SharedSamples, WithoutTheDepthOfTheFirstSampleTheNoteHasACondition) {
  for (const Depth depth : {Depth::None, Depth::Sky})
    EXPECT_THAT(notes_of(4, "4", depth), Contains(HasSubstr("V: if the renders differ in their seed, the first")));
}

TEST(SharedSamples, SubsetsOfOneSequenceAreNot) {
  EXPECT_THAT(notes_of(4, "4", Depth::OfLaterSamples), Not(Contains(alike)));
  EXPECT_THAT(notes_of(4, "16", Depth::None, 4), Not(Contains(alike)));
}

TEST(SharedSamples, LongRendersAndOtherRenderersAreNot) {
  EXPECT_THAT(notes_of(2, "16", Depth::Equal), Not(Contains(alike)));
  EXPECT_THAT(notes_of(4, "", Depth::Equal, 4), Not(Contains(alike)));
  EXPECT_THAT(notes_of(4, "16", Depth::Equal), Contains(alike));
}

}  // namespace
}  // namespace polyrecon
