#include "io/layers/channel_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

using ::testing::ElementsAre;

/// A part with float channels; a name that ends in "#" is a uint channel.
PartInfo part_with(const std::vector<std::string>& channels, const std::string& name = {},
                   const std::string& view = {}) {
  PartInfo part;
  part.name = name;
  part.view = view;
  for (const std::string& channel : channels) {
    const bool uint = channel.back() == '#';
    part.channels.push_back(
        {uint ? channel.substr(0, channel.size() - 1) : channel, uint ? SampleType::Uint : SampleType::Float});
  }
  return part;
}

FileInfo file_with(std::vector<PartInfo> parts) {
  FileInfo file;
  file.parts = std::move(parts);
  return file;
}

/// "A.RGB" stands for A.R, A.G, A.B. A name without a dot is letters too: a layer of one channel is "depth.Y".
std::vector<std::string> channels(const std::vector<std::string>& layers) {
  std::vector<std::string> names;
  for (const std::string& layer : layers) {
    const auto dot = layer.rfind('.');
    for (const char letter : layer.substr(dot + 1)) names.push_back(layer.substr(0, dot + 1) + letter);
  }
  std::sort(names.begin(), names.end());
  return names;
}

const Layer& named(const std::vector<Layer>& layers, const std::string& name) {
  const auto found = std::find_if(layers.begin(), layers.end(), [&](const Layer& l) { return l.name == name; });
  if (found == layers.end()) throw std::runtime_error("no layer " + name);
  return *found;
}

void expect_role(const std::vector<Layer>& layers, const std::string& name, Role role,
                 Companion companion = Companion::Mean, const std::string& of = {}) {
  const Layer& layer = named(layers, name);
  EXPECT_STREQ(name_of(layer.role), name_of(role)) << name;
  EXPECT_STREQ(name_of(layer.companion), name_of(companion)) << name;
  EXPECT_EQ(layer.of, of) << name;
}

TEST(ChannelNames, Blender3SinglePart) {
  const auto layers = find_layers(file_with({part_with(
      channels({"ViewLayer.Combined.RGBA", "ViewLayer.Denoising Albedo.RGB", "ViewLayer.Denoising Normal.XYZ",
                "ViewLayer.Denoising Depth.Z", "ViewLayer.Depth.Z", "ViewLayer.DiffCol.RGB", "ViewLayer.DiffDir.RGB",
                "ViewLayer.Shadow.RGB", "ViewLayer.AO.RGB", "ViewLayer.CryptoObject00.rgba", "ViewLayer.IndexOB.X",
                "ViewLayer.Vector.XYZW", "ViewLayer.UV.UVA", "ViewLayer.Debug Sample Count.X"}))}));
  expect_role(layers, "ViewLayer.Combined", Role::Beauty);
  expect_role(layers, "ViewLayer.Denoising Albedo", Role::Albedo);
  expect_role(layers, "ViewLayer.Denoising Normal", Role::Normal);
  expect_role(layers, "ViewLayer.Denoising Depth", Role::Depth);
  expect_role(layers, "ViewLayer.Shadow", Role::Visibility);
  expect_role(layers, "ViewLayer.Vector", Role::Motion);
  expect_role(layers, "ViewLayer.DiffDir", Role::Color);
  expect_role(layers, "ViewLayer.Debug Sample Count", Role::SampleCount);
  for (const char* data : {"ViewLayer.CryptoObject00", "ViewLayer.IndexOB", "ViewLayer.UV"})
    expect_role(layers, data, Role::Other);
  EXPECT_LT(named(layers, "ViewLayer.Denoising Depth").rank, named(layers, "ViewLayer.Depth").rank);
  EXPECT_LT(named(layers, "ViewLayer.Denoising Albedo").rank, named(layers, "ViewLayer.DiffCol").rank);
  EXPECT_LT(named(layers, "ViewLayer.Shadow").rank, named(layers, "ViewLayer.AO").rank);
  EXPECT_THAT(named(layers, "ViewLayer.Combined").channels,
              ElementsAre("ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"));
  EXPECT_EQ(named(layers, "ViewLayer.Combined").alpha, "ViewLayer.Combined.A");
  EXPECT_EQ(named(layers, "ViewLayer.Combined").view_layer, "ViewLayer");
  EXPECT_TRUE(is_sample_fraction(named(layers, "ViewLayer.Debug Sample Count").pass));
}

TEST(ChannelNames, Blender5HasOnePartForEachPass) {
  std::vector<PartInfo> parts;
  for (const char* layer :
       {"ViewLayer.Combined.RGBA", "ViewLayer.Noisy Image.RGBA", "ViewLayer.Denoising Albedo.RGB",
        "ViewLayer.Denoising Normal.XYZ", "ViewLayer.Denoising Depth.Z", "ViewLayer.Diffuse Color.RGB",
        "ViewLayer.Ambient Occlusion.RGB", "ViewLayer.Position.XYZ", "ViewLayer.Render Time.X"})
    parts.push_back(part_with(channels({layer}), std::string(layer).substr(0, std::string(layer).rfind('.'))));
  const auto layers = find_layers(file_with(parts));
  expect_role(layers, "ViewLayer.Noisy Image", Role::Beauty);
  expect_role(layers, "ViewLayer.Combined", Role::Prior);
  expect_role(layers, "ViewLayer.Diffuse Color", Role::Albedo);
  expect_role(layers, "ViewLayer.Ambient Occlusion", Role::Visibility);
  expect_role(layers, "ViewLayer.Position", Role::Other);
  expect_role(layers, "ViewLayer.Render Time", Role::Other);
  EXPECT_EQ(named(layers, "ViewLayer.Denoising Depth").part, 4);
}

TEST(ChannelNames, CompanionsThatMergeWrites) {
  const auto layers = find_layers(file_with({part_with(
      channels({"L.Combined.RGB", "L.Combined Variance.RGB", "L.Combined A.RGB", "L.Combined B.RGB", "L.Visibility.Z",
                "L.Visibility Variance.Z", "L.Visibility A.Z", "L.Visibility B.Z", "L.Sample Count.X"}))}));
  for (const std::string base : {"L.Combined", "L.Visibility"}) {
    const Role role = base == "L.Combined" ? Role::Beauty : Role::Visibility;
    expect_role(layers, base, role);
    expect_role(layers, base + " Variance", role, Companion::VarianceOfMean, base);
    expect_role(layers, base + " A", role, Companion::HalfA, base);
    expect_role(layers, base + " B", role, Companion::HalfB, base);
  }
  expect_role(layers, "L.Sample Count", Role::SampleCount);
  EXPECT_FALSE(is_sample_fraction(named(layers, "L.Sample Count").pass));
}

TEST(ChannelNames, ALayerCalledAIsNoHalfWithoutItsB) {
  const auto layers = find_layers(file_with({part_with(channels({"RGB", "Light.RGB", "Light A.RGB"}))}));
  expect_role(layers, "Light A", Role::Color);
}

TEST(ChannelNames, Arnold) {
  const auto layers = find_layers(
      file_with({part_with(channels({"RGBA", "variance.RGB", "diffuse_albedo.RGB", "N.XYZ", "Z", "RGBA_key.RGB",
                                     "crypto_asset00.RGBA", "AO.RGB", "RGBA_denoised.RGBA"}))}));
  expect_role(layers, "RGBA", Role::Beauty);
  expect_role(layers, "variance", Role::Beauty, Companion::VarianceOfMean, "RGBA");
  expect_role(layers, "diffuse_albedo", Role::Albedo);
  expect_role(layers, "N", Role::Normal);
  expect_role(layers, "Z", Role::Depth);
  expect_role(layers, "RGBA_key", Role::Color);
  expect_role(layers, "crypto_asset00", Role::Other);
  expect_role(layers, "AO", Role::Visibility);
  expect_role(layers, "RGBA_denoised", Role::Prior);
}

TEST(ChannelNames, RenderMan) {
  const auto layers = find_layers(file_with({part_with({"Ci.b",
                                                        "Ci.g",
                                                        "Ci.r",
                                                        "a",
                                                        "albedo.b",
                                                        "albedo.g",
                                                        "albedo.r",
                                                        "albedo_var.b",
                                                        "albedo_var.g",
                                                        "albedo_var.r",
                                                        "mse.b",
                                                        "mse.g",
                                                        "mse.r",
                                                        "normal.x",
                                                        "normal.y",
                                                        "normal.z",
                                                        "normal_var.x",
                                                        "normal_var.y",
                                                        "normal_var.z",
                                                        "sampleCount",
                                                        "z",
                                                        "z_var"})}));
  expect_role(layers, "Ci", Role::Beauty);
  EXPECT_THAT(named(layers, "Ci").channels, ElementsAre("Ci.r", "Ci.g", "Ci.b"));
  expect_role(layers, "mse", Role::Beauty, Companion::VarianceOfMean, "Ci");
  expect_role(layers, "albedo_var", Role::Albedo, Companion::VarianceOfSample, "albedo");
  expect_role(layers, "normal_var", Role::Normal, Companion::VarianceOfSample, "normal");
  expect_role(layers, "a", Role::Alpha);
  expect_role(layers, "z", Role::Depth);
  expect_role(layers, "z_var", Role::Depth, Companion::VarianceOfSample, "z");
  expect_role(layers, "sampleCount", Role::SampleCount);
}

TEST(ChannelNames, RenderManHalves) {
  const auto layers = find_layers(
      file_with({part_with(channels({"beauty.RGB", "beauty_mse.RGB", "beauty_even.RGB", "beauty_odd.RGB"}))}));
  expect_role(layers, "beauty_mse", Role::Beauty, Companion::VarianceOfMean, "beauty");
  expect_role(layers, "beauty_even", Role::Beauty, Companion::HalfA, "beauty");
  expect_role(layers, "beauty_odd", Role::Beauty, Companion::HalfB, "beauty");
}

TEST(ChannelNames, VRay) {
  const auto layers = find_layers(
      file_with({part_with(channels({"RGBA", "effectsResult.RGB", "diffuseFilter.RGB", "normals.XYZ", "zDepth.Z",
                                     "noiseLevel.R", "worldPositions.XYZ", "shadow.RGB", "GI.RGB"}))}));
  expect_role(layers, "RGBA", Role::Beauty);
  expect_role(layers, "effectsResult", Role::Prior);
  expect_role(layers, "diffuseFilter", Role::Albedo);
  expect_role(layers, "normals", Role::Normal);
  expect_role(layers, "zDepth", Role::Depth);
  expect_role(layers, "noiseLevel", Role::Other);
  expect_role(layers, "worldPositions", Role::Other);
  expect_role(layers, "shadow", Role::Visibility);
  expect_role(layers, "GI", Role::Color);
}

TEST(ChannelNames, Pbrt4) {
  const auto layers = find_layers(file_with({part_with(
      channels({"RGB", "Albedo.RGB", "N.XYZ", "Ns.XYZ", "P.XYZ", "Variance.RGB", "RelativeVariance.RGB", "u", "v"}))}));
  expect_role(layers, "RGBA", Role::Beauty);
  expect_role(layers, "Albedo", Role::Albedo);
  expect_role(layers, "Variance", Role::Beauty, Companion::VarianceOfSample, "RGBA");
  expect_role(layers, "RelativeVariance", Role::Other);
  expect_role(layers, "P", Role::Other);
  EXPECT_LT(named(layers, "Ns").rank, named(layers, "N").rank);
}

TEST(ChannelNames, MitsubaMomentOfNestedIntegrators) {
  // moment { img: aov { alb, nn, path } }: what Mitsuba 3.9 writes.
  const auto layers = find_layers(
      file_with({part_with(channels({"RGB", "img.XYZ", "img.albedo.RGB", "img.nn.XYZ", "img.path.RGBA", "m2_img.XYZ",
                                     "m2_img.albedo.RGB", "m2_img.nn.XYZ", "m2_img.path.RGBA"}))}));
  expect_role(layers, "RGBA", Role::Beauty);
  expect_role(layers, "m2_img.path", Role::Beauty, Companion::SecondMoment, "RGBA");
  expect_role(layers, "img.albedo", Role::Albedo);
  expect_role(layers, "m2_img.albedo", Role::Albedo, Companion::SecondMoment, "img.albedo");
  expect_role(layers, "m2_img.nn", Role::Normal, Companion::SecondMoment, "img.nn");
}

TEST(ChannelNames, MitsubaAov) {
  const auto layers =
      find_layers(file_with({part_with(channels({"RGB", "albedo.RGB", "depth.T", "img.RGBA", "sh_normal.XYZ"}))}));
  expect_role(layers, "RGBA", Role::Beauty);
  expect_role(layers, "depth", Role::Depth);
  expect_role(layers, "sh_normal", Role::Normal);
}

TEST(ChannelNames, MitsubaAovsMayHaveNamesOfOneLetter) {
  const auto layers = find_layers(file_with({part_with(channels({"RGB", "a.RGB", "img.RGBA", "n.XYZ", "z.T"}))}));
  expect_role(layers, "a", Role::Color);  // RenderMan's alpha "a" has one channel
  expect_role(layers, "n", Role::Normal);
  expect_role(layers, "z", Role::Depth);
}

TEST(ChannelNames, Appleseed) {
  const auto layers = find_layers(
      file_with({part_with(channels({"RGBA"}), "beauty"), part_with(channels({"RGB"}), "albedo"),
                 part_with(channels({"RGB"}), "normal"), part_with(channels({"Z"}), "depth"),
                 part_with(channels({"Y"}), "pixel_sample_count"), part_with(channels({"RGB"}), "direct_diffuse")}));
  expect_role(layers, "beauty", Role::Beauty);
  expect_role(layers, "albedo", Role::Albedo);
  expect_role(layers, "normal", Role::Normal);
  expect_role(layers, "depth", Role::Depth);
  expect_role(layers, "pixel_sample_count", Role::SampleCount);
  expect_role(layers, "direct_diffuse", Role::Color);
  EXPECT_EQ(named(layers, "beauty").alpha, "A");
}

TEST(ChannelNames, LuxCore) {
  const auto layers =
      find_layers(file_with({part_with(channels({"RGB_IMAGEPIPELINE.RGB", "ALBEDO.RGB", "AVG_SHADING_NORMAL.XYZ",
                                                 "GEOMETRY_NORMAL.XYZ", "DEPTH.Z", "SAMPLECOUNT.X"}))}));
  expect_role(layers, "RGB_IMAGEPIPELINE", Role::Beauty);
  expect_role(layers, "ALBEDO", Role::Albedo);
  expect_role(layers, "AVG_SHADING_NORMAL", Role::Normal);
  EXPECT_LT(named(layers, "AVG_SHADING_NORMAL").rank, named(layers, "GEOMETRY_NORMAL").rank);
  expect_role(layers, "DEPTH", Role::Depth);
  expect_role(layers, "SAMPLECOUNT", Role::SampleCount);
}

TEST(Case09, StereoInOnePart) {
  PartInfo part = part_with(
      {"B", "G", "R", "Z", "albedo.left.B", "albedo.left.G", "albedo.left.R", "right.B", "right.G", "right.R"});
  part.views = {"left", "right"};
  const auto layers = find_layers(file_with({part}));
  expect_role(layers, "RGBA", Role::Beauty);
  EXPECT_EQ(named(layers, "RGBA").view, "left");
  expect_role(layers, "right", Role::Beauty);
  EXPECT_EQ(named(layers, "right").view, "right");
  expect_role(layers, "albedo.left", Role::Albedo);
  EXPECT_EQ(named(layers, "albedo.left").view, "left");
}

TEST(Case09, StereoInSeveralParts) {
  const auto layers = find_layers(file_with(
      {part_with(channels({"RGB"}), "beauty.left", "left"), part_with(channels({"RGB"}), "beauty.right", "right")}));
  expect_role(layers, "beauty.left:beauty", Role::Beauty);
  EXPECT_EQ(named(layers, "beauty.right:beauty").view, "right");
}

TEST(Case09, DotsAndUtf8InViewLayers) {
  const auto layers =
      find_layers(file_with({part_with(channels({"Außen.Tür.Combined.RGB", "Außen.Tür.Denoising Depth.Z"}))}));
  expect_role(layers, "Außen.Tür.Combined", Role::Beauty);
  EXPECT_EQ(named(layers, "Außen.Tür.Combined").view_layer, "Außen.Tür");
}

TEST(ChannelNames, IdentifiersAreNoColor) {
  const auto layers = find_layers(file_with({part_with({"id.B#", "id.G#", "id.R#", "B", "G", "R"})}));
  expect_role(layers, "id", Role::Other);
}

TEST(ChannelNames, ANoisyLayerNextToItsResultIsTheBeautyAgain) {
  const auto layers = find_layers(file_with({part_with(channels({"L.Combined.RGB", "L.Combined Noisy.RGB"}))}));
  expect_role(layers, "L.Combined Noisy", Role::Beauty);
  expect_role(layers, "L.Combined", Role::Prior);
}

TEST(ChannelNames, SamplesInMetadata) {
  FileInfo file = file_with({part_with({"B", "G", "R"})});
  EXPECT_FALSE(samples_in_metadata(file, "ViewLayer"));
  file.parts[0].attributes = {{"cycles.ViewLayer.samples", "string", "64"}};
  EXPECT_EQ(samples_in_metadata(file, "ViewLayer"), 64);
  EXPECT_FALSE(samples_in_metadata(file, "Other"));
  file.parts[0].attributes = {{"samplesPerPixel", "int", "16"}};
  EXPECT_EQ(samples_in_metadata(file, ""), 16);
}

}  // namespace
}  // namespace polyrecon
