#include "io/renderers/renderers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"
#include "support/recorded.h"

namespace polyrecon {
namespace {

using ::testing::ElementsAre;

using Cells = std::vector<std::string>;

std::string row(const Cells& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += cell.empty() ? " |" : " " + cell + " |";
  return text + "\n";
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string out;
  while (count-- > 0) out += text;
  return out;
}

std::string code(const std::string& text) { return "`" + text + "`"; }

/// Names of one role, the one that is taken first in front.
Cells names_of(const Renderer& renderer, Role role) {
  std::vector<PassName> passes;
  for (const PassName& pass : renderer.passes)
    if (pass.role == role) passes.push_back(pass);
  std::stable_sort(passes.begin(), passes.end(), [](const PassName& a, const PassName& b) { return a.rank < b.rank; });
  Cells names;
  for (const PassName& pass : passes)
    names.push_back(code(pass.name) + (pass.name == renderer.sample_fraction ? " x the metadata's number" : ""));
  for (const PassName& letter : renderer.letters)
    if (letter.role == role) names.push_back(code("<layer>." + letter.name));
  return names;
}

/// Layers that are priors because of the names of others.
Cells priors_of(const Renderer& renderer) {
  Cells names = names_of(renderer, Role::Prior);
  for (const PassName& pass : renderer.passes)
    if (!renderer.noisy_beauty.empty() && pass.role == Role::Beauty && pass.name != renderer.noisy_beauty)
      names.push_back(code(pass.name) + " next to " + code(renderer.noisy_beauty));
  for (const std::string& suffix : renderer.denoised_suffixes) names.push_back(code("<beauty>" + suffix));
  if (!renderer.noisy_suffix.empty())
    names.push_back(code("<beauty>") + " next to " + code("<beauty>" + renderer.noisy_suffix));
  return names;
}

Cells companions_of(const Renderer& renderer) {
  Cells names;
  for (const BeautyCompanion& known : renderer.beauty_companions)
    names.push_back(fmt::format("{} ({}, of the beauty)", code(known.name), name_of(known.companion)));
  for (const CompanionAffix& affix : renderer.affixes) {
    const bool before = affix.place == CompanionAffix::Place::BeforeWord;
    names.push_back(fmt::format("{} ({})", code(before ? affix.text + "<layer>" : "<layer>" + affix.text),
                                name_of(affix.companion)));
  }
  return names;
}

Cells attributes_of(const Renderer& renderer) {
  Cells names;
  for (const SamplesAttribute& attribute : renderer.samples_attributes)
    names.push_back(code(with_view_layer(attribute.name, "LAYER")));
  return names;
}

std::string names_table() {
  Cells head{"renderer"};
  for (const RoleInfo& info : role_table())
    if (info.chosen) head.emplace_back(info.name);
  for (const char* more : {"companions", "samples in the metadata"}) head.emplace_back(more);
  std::string table = row(head) + "|" + repeated("---|", head.size()) + "\n";
  for (const Renderer& renderer : renderers()) {
    Cells cells{renderer.versions.empty() ? renderer.name : renderer.name + ", " + renderer.versions};
    for (const RoleInfo& info : role_table())
      if (info.chosen)
        cells.push_back(fmt::format(
            "{}", fmt::join(info.role == Role::Prior ? priors_of(renderer) : names_of(renderer, info.role), ", ")));
    for (const Cells& more : {companions_of(renderer), attributes_of(renderer)})
      cells.push_back(fmt::format("{}", fmt::join(more, ", ")));
    table += row(cells);
  }
  return table;
}

constexpr const char* formats_page = POLYRECON_SOURCE_DIR "/docs/reference/formats.md";

TEST(Renderers, ThePageOfFormatsHasTheirNames) {
  test::expect_recorded(formats_page, "<!-- renderers: begin -->\n", "<!-- renderers: end -->", names_table());
}

/// The descriptions are written by hand and stay.
TEST(Renderers, ThePageOfFormatsHasTheRoles) {
  const std::string head = "| role | channels | what it is |\n|---|---:|---|\n";
  const std::string recorded = test::between(test::text_of(formats_page), head, "\n\n") + "\n";
  std::string rows;
  for (const RoleInfo& info : role_table()) {
    const std::string channels = info.channels > 0 ? std::to_string(info.channels) : "any";
    const std::string begin = fmt::format("| {} | {} | ", code(info.name), channels);
    const std::string description = test::between(recorded, begin, " |\n");
    EXPECT_FALSE(description.empty()) << formats_page << ": write what the role " << info.name << " is";
    rows += (rows.empty() ? "" : "\n") + begin + description + " |";
  }
  test::expect_recorded(formats_page, head, "\n\n", rows);
}

TEST(Renderers, HaveDistinctNamesAndBeauties) {
  std::set<std::string> names;
  for (const Renderer& renderer : renderers()) {
    EXPECT_TRUE(names.insert(renderer.name).second) << renderer.name;
    for (const PassName& pass : renderer.passes) {
      const auto known = classify_pass(pass.name);
      ASSERT_TRUE(known) << pass.name;
      EXPECT_STREQ(name_of(known->role), name_of(pass.role)) << renderer.name << ": " << pass.name;
      EXPECT_NE(known->renderers.find(renderer.name), std::string::npos) << renderer.name << ": " << pass.name;
    }
  }
}

TEST(Renderers, EachFileIsInTheList) {
  const std::set<std::string> others{"known_names", "renderers"};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(POLYRECON_SOURCE_DIR "/src/io/renderers"))
    files += entry.path().extension() == ".cpp" && others.count(entry.path().stem().string()) == 0;
  EXPECT_EQ(renderers().size(), files) << "src/io/renderers/renderers.cpp lists each file of its folder";
}

TEST(Renderers, HaveRolesThatTheirBeautyTells) {
  EXPECT_TRUE(can_have("Combined", Role::Visibility));  // Blender
  EXPECT_TRUE(can_have("ci", Role::SampleCount));       // RenderMan
  EXPECT_FALSE(can_have("Ci", Role::Visibility));
  EXPECT_TRUE(can_have("RGB", Role::Depth));  // Mitsuba, though not pbrt
  EXPECT_TRUE(can_have("my colours", Role::Visibility) && can_have("", Role::Beauty));
}

TEST(Renderers, NamesAreComparedWithoutCaseAndSeparators) {
  EXPECT_TRUE(same_name("Noisy Image", "noisy_image"));
  EXPECT_TRUE(same_name("Z-Depth", "zDepth"));
  EXPECT_FALSE(same_name("Z-Depth", "Z.Depth"));
  EXPECT_EQ(classify_pass("zDepth")->renderers, "V-Ray, Octane");
  EXPECT_EQ(classify_pass("RGB")->renderers, "pbrt, Mitsuba, POV-Ray");
  EXPECT_FALSE(classify_pass(""));
  EXPECT_FALSE(classify_pass("Albedo2"));
}

TEST(Renderers, DataHavePrefixes) {
  EXPECT_TRUE(has_data_prefix("CryptoObject00") && has_data_prefix("IndexOB") && has_data_prefix("Debug BVH"));
  EXPECT_FALSE(has_data_prefix("Combined") || has_data_prefix("myIndex"));
}

TEST(Renderers, QuirksOfBlender) {
  EXPECT_TRUE(is_noisy_beauty("Noisy Image"));
  EXPECT_FALSE(is_noisy_beauty("Combined") || is_noisy_beauty(""));
  EXPECT_TRUE(is_sample_fraction("Debug Sample Count"));
  EXPECT_FALSE(is_sample_fraction("Sample Count") || is_sample_fraction(""));
  EXPECT_TRUE(is_render_time("Render Time"));
  EXPECT_FALSE(is_render_time("") || is_render_time("Combined"));
  EXPECT_EQ(sky_value(), 1e10);
  EXPECT_EQ(sky_depth(), 1e9);  // a tenth of it
  EXPECT_TRUE(is_compositing_depth("Depth") && is_compositing_depth("depth"));
  EXPECT_FALSE(is_compositing_depth("Denoising Depth") || is_compositing_depth(""));
}

TEST(Renderers, MotionIsTakenAsBlendersWhereNoRendererHasTheName) {
  EXPECT_THAT(motion_factors("Vector"), ElementsAre(1, -1, -1, 1));
  EXPECT_THAT(motion_factors("my vectors"), ElementsAre(1, -1, -1, 1));
}

TEST(Renderers, AttributesAndFileNames) {
  Cells names;
  for (const SamplesAttribute& attribute : samples_attributes("View.L")) names.push_back(attribute.name);
  EXPECT_THAT(names, ElementsAre("polyrecon/View.L/samples", "cycles.View.L.samples", "samplesPerPixel"));
  EXPECT_THAT(companion_endings(),
              ElementsAre(" Variance", " A", " B", "_variance", "_var", "_mse", "_even", "_odd", "Variance", "A", "B"));
  EXPECT_THAT(denoised_endings(), ElementsAre("_denoised", "_denoise", " Denoised"));
}

TEST(Renderers, ThePictureIsTheDenoisedBeautyOfTheFirstViewLayer) {
  const auto layer = [](const char* view_layer, Role role, int rank) {
    Layer l;
    l.view_layer = view_layer;
    l.role = role;
    l.rank = rank;
    return l;
  };
  std::vector<Layer> layers{layer("A", Role::Albedo, 1), layer("A", Role::Beauty, 2), layer("A", Role::Beauty, 1),
                            layer("B", Role::Prior, 1)};
  EXPECT_EQ(picture_layer(layers), &layers[2]);
  layers[3].view_layer = "A";
  EXPECT_EQ(picture_layer(layers), &layers[3]);
  layers[3].rank = rank_of_made_prior;
  EXPECT_EQ(picture_layer(layers), &layers[2]);
  layers[2].companion = Companion::HalfA;
  EXPECT_EQ(picture_layer(layers), &layers[1]);
  layers.resize(1);
  EXPECT_EQ(picture_layer(layers), nullptr);
}

}  // namespace
}  // namespace polyrecon
