#include "polyrecon/merge.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "io/exr_fixture.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using testing::constant;
using ::testing::Contains;
using ::testing::Each;
using testing::error_of;
using testing::flat_layer;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::join;
using testing::layer;
using ::testing::SizeIs;
using testing::stored_bytes;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::with_text;
using testing::write_all;
using testing::write_exr;

/// One render whose beauty is the same everywhere.
TestPart render(double value, const std::string& samples = {}) {
  TestPart part;
  part.channels = join({flat_layer("V.Combined", "RGBA", value), flat_layer("V.Denoising Depth", "Z", 10 * value)});
  if (!samples.empty()) part.edit = with_text("cycles.V.samples", samples);
  return part;
}

std::string samples_attribute(const std::string& path) {
  return find_attribute(describe_file(path).parts[0], "cycles.V.samples")->value;
}

TEST(MergeRenders, GivenHalvesAreAveragedAlikeWhateverTheirCounts) {
  // A: 1 (1 sample), 4 (2 samples): mean 3. B: 5 (10 samples), 8 (20 samples): mean 7. The picture is 5, not the 73 /
  // 11 of all samples alike. One sample: (1 * 62^2 + 4 * 29^2 + 100 * 18^2 + 400 * 15^2) / 11^2 / (33 - 505 / 33); the
  // picture's variance is that times (1 / 3 + 1 / 30) / 4.
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  std::vector<TestPart> renders;
  for (const auto& [value, samples] : std::vector<std::pair<double, double>>{{1, 1}, {4, 2}, {5, 10}, {8, 20}}) {
    TestPart part;
    part.channels = join({flat_layer("V.Combined", "RGBA", value), flat_layer("V.Sample Count", "X", samples)});
    renders.push_back(part);
  }
  const auto paths = write_all(folder, renders);
  MergeOptions options;
  options.half_b = {paths[2], paths[3]};
  merge({paths[0], paths[1]}, out, options);
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.R"), Each(5.0F));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.A"), Each(5.0F));
  const double of_a_sample = (62 * 62 + 4 * 29 * 29 + 100 * 18 * 18 + 400 * 15 * 15) / 121.0 / (33 - 505 / 33.0);
  EXPECT_THAT(stored_floats(out, 0, "V.Combined Variance.R"),
              Each(::testing::FloatEq(static_cast<float>(of_a_sample * (1 / 3.0 + 1 / 30.0) / 4))));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined A.R"), Each(3.0F));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined B.R"), Each(7.0F));
  EXPECT_THAT(stored_floats(out, 0, "V.Sample Count.X"), Each(33.0F));
}

TEST(MergeRenders, MeansOfHalfFloatsAreFloats) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  std::vector<TestPart> renders;
  for (const int seed : {1, 2, 3}) {
    TestPart part;
    part.channels = join({layer("V.Combined", "RGBA", seed, Imf::HALF), layer("V.Denoising Depth", "Z", seed)});
    renders.push_back(part);
  }
  merge(write_all(folder, renders), out);
  const FileInfo file = describe_file(out);
  for (const ChannelInfo& channel : file.parts[0].channels) EXPECT_EQ(channel.type, SampleType::Float) << channel.name;
}

TEST(MergeRenders, ALossyCompressionIsForJoinedColoursAlone) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  MergeOptions options;
  options.encoding.compression = Compression::Dwaa;
  std::vector<TestPart> regions;
  for (const int x : {0, 32}) {
    TestPart part;
    part.window = {x, 0, x + 32, 32};
    part.display = {0, 0, 64, 32};
    part.channels = join({layer("V.Combined", "RGB", 1, Imf::HALF), layer("V.CryptoObject00", "rgba", 9)});
    regions.push_back(part);
  }
  EXPECT_TRUE(merge(write_all(folder, regions), out, options).joined);
  EXPECT_EQ(describe_file(out).parts[0].compression, "dwaa");
  EXPECT_EQ(describe_file(out).parts[0].channels.front().type, SampleType::Half);

  const MergeResult result = merge(write_all(folder, {render(1), render(2)}), out, options);
  EXPECT_THAT(result.notes, Contains(HasSubstr("written with ZIP: dwaa would change V.Combined A.B")));
  EXPECT_EQ(describe_file(out).parts[0].compression, "zip");
}

TEST(MergeRenders, LayersOfTheFirstFileAloneAreKept) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  TestPart first = render(1);
  first.channels = join({first.channels, flat_layer("V.Depth", "Z", 0.5), flat_layer("V.IndexOB", "X", 7)});
  const auto paths = write_all(folder, {first, render(3), render(5)});
  const MergeResult result = merge(paths, out);
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.R"), Each(3.0F));
  EXPECT_THAT(stored_floats(out, 0, "V.Depth.Z"), Each(0.5F));
  EXPECT_THAT(result.kept, Contains("V.IndexOB"));
  const auto mixed = write_all(folder, {first, first, render(5)});
  EXPECT_THAT(error_of([&] { merge(mixed, out); }).what(), HasSubstr("no layer V."));
}

TEST(MergeRenders, MeanVarianceAndHalvesOfEqualRenders) {
  // 1, 2, 6: mean 3; sum of squared deviations 4 + 1 + 9 = 14, variance of the mean 14 / 2 / 3 = 7/3; A = (1 + 6) / 2;
  // B = 2.
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const MergeResult result = merge(write_all(folder, {render(1), render(2), render(6)}), out);
  EXPECT_EQ(result.files, 3);
  EXPECT_EQ(result.samples, 0);
  EXPECT_THAT(result.notes, Contains(HasSubstr("sample counts are unknown")));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.R"), Each(3.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.A"), Each(3.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined Variance.G"), Each(::testing::FloatEq(7.f / 3.f)));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined A.B"), Each(3.5f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined B.B"), Each(2.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Denoising Depth.Z"), Each(30.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Denoising Depth Variance.Z"), Each(::testing::FloatEq(700.f / 3.f)));
}

TEST(MergeRenders, MetadataWeighTheRenders) {
  // 4 samples of mean 1, 12 of mean 5: (4 + 60) / 16 = 4; (4 * 9 + 12 * 1) / ((2 - 1) * 16) = 3.
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const MergeResult result = merge(write_all(folder, {render(1, "4"), render(5, "12")}), out);
  EXPECT_EQ(result.samples, 16);
  EXPECT_THAT(result.notes, Contains(HasSubstr("--samples")));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.R"), Each(4.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined Variance.R"), Each(3.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined A.R"), Each(1.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined B.R"), Each(5.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Sample Count.X"), Each(16.f));
  EXPECT_EQ(find_attribute(describe_file(out).parts[0], "cycles.V.samples")->value, "16");
}

TEST(MergeRenders, TheSamplesInTheMetadataAddUpWhateverTheTypeOfTheAttribute) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const auto pbrt = [](double value, const Imf::Attribute& samples) {
    TestPart part;
    part.channels = flat_layer("", "RGB", value);
    part.edit = [&samples](Imf::Header& header) { header.insert("samplesPerPixel", samples); };
    return part;
  };
  const Imf::IntAttribute whole(16);
  const Imf::FloatAttribute real(16);
  const Imf::DoubleAttribute precise(16);
  const Imf::StringAttribute text("16");
  for (const Imf::Attribute* samples : std::initializer_list<const Imf::Attribute*>{&whole, &real, &precise, &text}) {
    merge(write_all(folder, {pbrt(0, *samples), pbrt(4, *samples)}), out);
    const AttributeInfo* merged = find_attribute(describe_file(out).parts[0], "samplesPerPixel");
    ASSERT_NE(merged, nullptr);
    EXPECT_EQ(std::stod(merged->value), 32) << samples->typeName();
    const Imf::InputFile file(out.c_str());
    EXPECT_STREQ(file.header()["samplesPerPixel"].typeName(), samples->typeName());
  }
}

TEST(MergeRenders, LongRendersWeighMoreInTheVarianceThanShortOnes) {
  // 1, 1 and 2 samples of 0, 4, 2: mean 2; (1 * 4 + 1 * 4 + 4 * 0) / (16 - 6) = 0.8, while all renders alike would say
  // (1 * 4 + 1 * 4 + 2 * 0) / (2 * 4) = 1.
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  merge(write_all(folder, {render(0, "1"), render(4, "1"), render(2, "2")}), out);
  EXPECT_THAT(stored_floats(out, 0, "V.Combined.R"), Each(2.f));
  EXPECT_THAT(stored_floats(out, 0, "V.Combined Variance.R"), Each(::testing::FloatEq(0.8f)));
}

TEST(MergeRenders, HalvesHaveAboutTheSameSamples) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const auto counted = [](double value, double samples) {
    TestPart part;
    part.channels = join({flat_layer("V.Combined", "RGB", value), flat_layer("V.Sample Count", "X", samples)});
    return part;
  };
  const auto halves = [&](const std::vector<TestPart>& renders) {
    const MergeResult result = merge(write_all(folder, renders), out);
    EXPECT_THAT(stored_floats(out, 0, "V.Combined A.R"), Each(stored_floats(out, 0, "V.Combined A.R").front()));
    return std::tuple(stored_floats(out, 0, "V.Combined A.R").front(), stored_floats(out, 0, "V.Combined B.R").front(),
                      result.notes.size());
  };
  EXPECT_EQ(halves({counted(1, 4), counted(3, 4), counted(5, 4), counted(7, 4)}), std::tuple(3.F, 5.F, 0U));
  EXPECT_EQ(halves({counted(1, 1), counted(3, 1), counted(5, 1), counted(7, 1), counted(9, 4)}),
            std::tuple(9.F, 4.F, 0U));
  EXPECT_EQ(halves({counted(1, 2), counted(3, 8)}), std::tuple(1.F, 3.F, 1U));  // the note: they cannot be even
}

TEST(MergeRenders, SamplesGivenByHandReplaceTheMetadata) {
  // Blender 5 writes 16 into each of 4 subsets of 4 samples, and a fraction of 1 of them into every pixel.
  const TemporaryFolder folder;
  std::vector<TestPart> renders;
  for (int k = 0; k < 4; ++k) {
    renders.push_back(render(k, "16"));
    renders.back().channels.push_back({"V.Debug Sample Count.X", Imf::FLOAT, constant(1)});
  }
  MergeOptions options;
  options.samples = 4;
  const std::string out = folder / "out.exr";
  const MergeResult result = merge(write_all(folder, renders), out, options);
  EXPECT_EQ(result.samples, 16);
  EXPECT_THAT(result.notes, IsEmpty());
  EXPECT_THAT(stored_floats(out, 0, "V.Sample Count.X"), Each(16.f));
  EXPECT_EQ(samples_attribute(out), "16");
}

TEST(MergeRenders, SampleCountPassesWeighEveryPixel) {
  // Fractions of 8: pixel x = 0 has 8 and 0 samples, the others 4 and 8: (4 * 1 + 8 * 4) / 12 = 3, (4 * 4 + 8 * 1) / 12
  // = 2.
  const TemporaryFolder folder;
  TestPart a = render(1, "8"), b = render(4, "8");
  a.channels.push_back({"V.Debug Sample Count.X", Imf::FLOAT, [](int x, int) { return x == 0 ? 1.0 : 0.5; }});
  b.channels.push_back({"V.Debug Sample Count.X", Imf::FLOAT, [](int x, int) { return x == 0 ? 0.0 : 1.0; }});
  const std::string out = folder / "out.exr";
  const MergeResult result = merge(write_all(folder, {a, b}), out);
  EXPECT_THAT(result.dropped, Contains("V.Debug Sample Count"));
  const auto mean = stored_floats(out, 0, "V.Combined.R"), variance = stored_floats(out, 0, "V.Combined Variance.R"),
             half_b = stored_floats(out, 0, "V.Combined B.R"), count = stored_floats(out, 0, "V.Sample Count.X");
  EXPECT_EQ(mean[0], 1);
  EXPECT_TRUE(std::isnan(variance[0]));  // one render has no spread
  EXPECT_EQ(half_b[0], 1);
  EXPECT_EQ(count[0], 8);
  EXPECT_EQ(mean[1], 3);
  EXPECT_EQ(variance[1], 2);
  EXPECT_EQ(half_b[1], 4);
  EXPECT_EQ(count[1], 12);
  const ReadResult read = read_frame(out);
  EXPECT_EQ(read.source.chosen.back().layer, "V.Sample Count");
  EXPECT_EQ(read.frame.sample_count.at(1, 0, 0), 12);
}

TEST(MergeRenders, SamplesThatAreNotFiniteAreLeftOut) {
  const TemporaryFolder folder;
  TestPart bad = render(2);
  bad.channels[0].samples = [](int x, int y) {
    return x == 3 && y == 2 ? std::numeric_limits<double>::quiet_NaN() : 2.0;
  };
  const std::string channel = bad.channels[0].name, out = folder / "out.exr";
  const MergeResult result = merge(write_all(folder, {render(1), bad, render(3)}), out);
  EXPECT_THAT(result.notes, Contains(HasSubstr("1 samples that are not finite")));
  EXPECT_THAT(stored_floats(out, 0, channel), Each(2.f));
}

TEST(MergeRenders, OtherPassesComeFromTheFirstFileBitForBit) {
  const TemporaryFolder folder;
  std::vector<TestPart> renders;
  for (int k = 0; k < 2; ++k) {
    TestPart part;
    part.channels =
        join({layer("V.Combined", "RGB", k), layer("V.CryptoObject00", "rgba", 50 + k), layer("V.Depth", "Z", 60 + k),
              layer("V.Denoising Depth", "Z", 70 + k), layer("V.IndexOB", "X", 80 + k, Imf::UINT),
              layer("V.Vector", "XYZW", 90 + k, Imf::HALF), layer("V.Combined Variance", "RGB", 99)});
    part.window = {-3, 2, 11, 80};
    part.display = {0, 0, 10, 70};
    part.edit = [](Imf::Header& header) { Imf::addOwner(header, "studio"); };
    renders.push_back(part);
  }
  const auto paths = write_all(folder, renders);
  const std::string out = folder / "out.exr";
  const MergeResult result = merge(paths, out);
  EXPECT_THAT(result.merged, ::testing::ElementsAre("V.Combined", "V.Denoising Depth"));
  EXPECT_THAT(result.dropped, ::testing::ElementsAre("V.Combined Variance"));
  for (const auto& channel : renders[0].channels)
    if (channel.name.find("Combined") == std::string::npos && channel.name != "V.Denoising Depth.Z") {
      EXPECT_EQ(stored_bytes(out, 0, channel.name), stored_bytes(paths[0], 0, channel.name)) << channel.name;
    }
  const FileInfo file = describe_file(out);
  EXPECT_EQ(file.parts[0].data_window, renders[0].window);
  EXPECT_EQ(file.parts[0].display_window, renders[0].display);
  EXPECT_EQ(find_attribute(file.parts[0], "owner")->value, "studio");
}

TEST(MergeRenders, MultiPartFilesBecomeOnePart) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  for (const double value : {1.0, 3.0}) {
    std::vector<TestPart> parts(3);
    parts[0].channels = flat_layer("V.Combined", "RGBA", value);
    parts[1].channels = flat_layer("V.Denoising Normal", "XYZ", value);
    parts[2].channels = layer("V.CryptoObject00", "rgba", 7);
    for (TestPart& part : parts) part.name = part.channels[0].name.substr(0, part.channels[0].name.rfind('.'));
    paths.push_back(write_exr(folder / ("m" + std::to_string(value) + ".exr"), parts));
  }
  const std::string out = folder / "out.exr";
  merge(paths, out);
  const ReadResult read = read_frame(out);
  ASSERT_THAT(read.source.files[0].parts, SizeIs(1));
  EXPECT_EQ(read.source.files[0].parts[0].name, "");
  EXPECT_EQ(read.frame.beauty.mean.at(0, 0, 0), 2);
  EXPECT_EQ(read.frame.beauty.variance.at(0, 0, 0), 1);
  ASSERT_THAT(read.frame.features, SizeIs(1));
  EXPECT_EQ(read.frame.features[0].pass.half_b.at(0, 0, 2), 3);
  EXPECT_EQ(stored_bytes(out, 0, "V.CryptoObject00.a"), stored_bytes(paths[0], 2, "V.CryptoObject00.a"));
}

TEST(MergeRenders, StereoPartsBecomeViewsOfOnePart) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  for (const double value : {1.0, 3.0}) {
    std::vector<TestPart> parts(2);
    parts[0].channels = flat_layer("", "RGB", value);
    parts[1].channels = flat_layer("", "RGB", 10 * value);
    parts[0].view = "left";
    parts[1].view = "right";
    for (TestPart& part : parts) part.name = "beauty." + part.view;
    paths.push_back(write_exr(folder / ("s" + std::to_string(value) + ".exr"), parts));
  }
  const std::string out = folder / "out.exr";
  merge(paths, out);
  ReadOptions options;
  for (const auto& [view, scale] : {std::pair{"left", 1.0}, std::pair{"right", 10.0}}) {
    options.view = view;
    const Frame frame = read_frame(out, options).frame;
    EXPECT_EQ(static_cast<double>(frame.beauty.mean.at(0, 0, 0)), 2 * scale);
    EXPECT_EQ(static_cast<double>(frame.beauty.variance.at(0, 0, 0)), scale * scale);
    EXPECT_EQ(static_cast<double>(frame.beauty.half_b.at(0, 0, 0)), 3 * scale);
  }
}

TEST(MergeRenders, LayersWithoutANameAndTheirCompanionsAreFoundAgain) {
  const TemporaryFolder folder;
  std::vector<TestPart> renders(2);
  for (std::size_t k = 0; k < 2; ++k) {
    const double value = 1 + 2 * static_cast<double>(k);
    renders[k].channels =
        join({flat_layer("", "RGB", value), flat_layer("Z", "Z", value), flat_layer("albedo", "RGB", value)});
    renders[k].channels[3].name = "Z";
    renders[k].tile = 4;
  }
  const std::string out = folder / "out.exr";
  merge(write_all(folder, renders), out);
  const Frame frame = read_frame(out).frame;
  EXPECT_EQ(frame.beauty.variance.at(0, 0, 0), 1);
  EXPECT_EQ(frame.beauty.half_b.at(0, 0, 0), 3);
  ASSERT_THAT(frame.features, SizeIs(2));
  for (const Feature& feature : frame.features) EXPECT_EQ(feature.pass.half_a.at(0, 0, 0), 1);
}

TEST(MergeRenders, AllBandsOfATallFrame) {
  const TemporaryFolder folder;
  std::vector<TestPart> renders(4);
  for (int k = 0; k < 4; ++k) {
    renders[static_cast<std::size_t>(k)].channels = layer("V.Combined", "RGB", 3 * k);
    renders[static_cast<std::size_t>(k)].window = {0, -9, 5, 700};
  }
  const std::string out = folder / "out.exr";
  merge(write_all(folder, renders), out);
  const auto mean = stored_floats(out, 0, "V.Combined.G");
  for (int y = -9; y < 700; ++y)
    for (int x = 0; x < 5; ++x) {
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += testing::pattern(3 * k + 1)(x, y);
      ASSERT_FLOAT_EQ(mean[static_cast<std::size_t>((y + 9) * 5 + x)], static_cast<float>(sum / 4));
    }
}

TEST(MergeRenders, RefusesOneFileTheSameFileTwiceAndFilesThatDoNotFit) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr", first = write_exr(folder / "a.exr", {render(1)});
  EXPECT_EQ(error_of([&] { merge({first}, out); }).code(), ExitCode::Usage);
  EXPECT_EQ(error_of([&] { merge({}, out); }).code(), ExitCode::Usage);
  EXPECT_EQ(error_of([&] { merge({first, first}, out); }).code(), ExitCode::Usage);
  TestPart display = render(2), fewer = render(2), more = render(2), other = render(2);
  display.display = {0, 0, 9, 9};
  fewer.channels.pop_back();
  more.channels.push_back({"V.Extra.X", Imf::FLOAT, constant(0)});
  other.channels.erase(other.channels.begin());
  int number = 0;
  for (const TestPart& part : {display, fewer, more, other}) {
    const std::string path = write_exr(folder / ("bad" + std::to_string(number++) + ".exr"), {part});
    const Error error = error_of([&] { merge({first, path}, out); });
    EXPECT_EQ(error.code(), ExitCode::BadInput);
    EXPECT_EQ(std::string(error.what()).rfind(path, 0), 0u) << error.what();
  }
  EXPECT_EQ(error_of([&] { merge({first, folder / "none.exr"}, out); }).code(), ExitCode::Missing);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(MergeRenders, RefusesABandThatTheLimitDoesNotHold) {
  const TemporaryFolder folder;
  const auto paths = write_all(folder, {render(1), render(2)});
  MergeOptions options;
  options.limits.max_bytes = 1000;
  const Error error = error_of([&] { merge(paths, folder / "m.exr", options); });
  EXPECT_EQ(error.code(), ExitCode::OutOfMemory);
  EXPECT_THAT(error.what(), HasSubstr(paths[0]));
}

TEST(MergeRenders, EqualRendersAreSuspicious) {
  const TemporaryFolder folder;
  const MergeResult result = merge(write_all(folder, {render(2), render(2)}), folder / "out.exr");
  EXPECT_THAT(result.notes, Contains(HasSubstr("same seed")));
}

}  // namespace
}  // namespace polyrecon
