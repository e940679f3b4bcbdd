#include "cli/denoise/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "polyrecon/error.h"
#include "presets/preset.h"

namespace polyrecon {
namespace {

using Words = std::vector<std::string>;

/// A command line of denoise, parsed.
class CommandLine {
 public:
  explicit CommandLine(Words words) : set_(app_) {
    add_denoise_options(set_, options_);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app_.parse(words);
  }
  Job job() const { return make_job(options_, set_); }
  std::multiset<std::string> option_names() const {
    std::multiset<std::string> names;
    const CLI::App& app = app_;
    for (const CLI::Option* option : app.get_options())
      names.insert("--" + option->get_lnames().front());  // get_name() hides hidden ones
    return names;
  }

 private:
  CLI::App app_;
  DenoiseOptions options_;
  OptionSet set_;
};

const Words file{"-i", "in.exr", "-o", "out.exr"};
const Words sequence{"-i", "shot.####.exr", "-o", "out.####.exr", "--frames", "1-3"};
const Words with_map{"-i", "in.exr", "-o", "out.exr", "--sample-map", "map.exr", "--budget", "4"};

const Words with_oidn{"-i", "in.exr", "-o", "out.exr", "--prior", "oidn"};

Job job_of(const Words& more, Words words = file) {
  words.insert(words.end(), more.begin(), more.end());
  return CommandLine(words).job();
}

/// An option of denoise and a value, and what stands in its place on the other command line: nothing, or another value
/// of an option that cannot be omitted.
struct OptionCase {
  Changes changes;
  Words with, without = {};
  Words base = file;
};

/// Every option. One that is new must be added here, with the decision whether the result depends on it.
const std::vector<OptionCase> cases{
    {Changes::Run, {"--input", "other.exr"}, {"--input", "in.exr"}, {"-o", "out.exr"}},
    {Changes::Run, {"--output", "other.exr"}, {"--output", "out.exr"}, {"-i", "in.exr"}},
    {Changes::Run, {"--error-map", "e.exr"}},
    {Changes::Run, {"--order-map", "o.exr"}},
    {Changes::Run,
     {"--sample-map", "a.exr"},
     {"--sample-map", "b.exr"},
     {"-i", "in.exr", "-o", "out.exr", "--budget", "4"}},
    {Changes::Run, {"--report", "r.json"}},
    {Changes::Result, {"--aov", "Diffuse Direct"}},
    {Changes::Result, {"--map", "albedo=Colour"}},
    {Changes::Result, {"--prior", "Denoised"}},
    {Changes::Result, {"--oidn", "/lib"}, {}, with_oidn},
    {Changes::Result, {"--oidn-device", "cpu"}, {}, with_oidn},
    {Changes::Result, {"--view-layer", "Other"}},
    {Changes::Result, {"--view", "right"}},
    {Changes::Result, {"--variance-kind", "sample"}},
    {Changes::Result, {"--wrap", "x"}},
    {Changes::Result, {"--samples", "16"}},
    {Changes::Run, {"--frames", "1-3"}, {"--frames", "2"}, {"-i", "shot.####.exr", "-o", "out.####.exr"}},
    {Changes::Result, {"--frame-radius", "1"}, {}, sequence},
    {Changes::Run, {"--skip-existing"}},
    {Changes::Run, {"--wait", "3"}},
    {Changes::Run, {"--strict"}},
    {Changes::Run, {"--dry-run"}},
    {Changes::Result, {"--quality", "best"}},
    {Changes::Result, {"--stages", "3"}},
    {Changes::Result, {"--order", "1"}},
    {Changes::Result, {"--time-budget", "5"}},
    {Changes::Result, {"--steps", "all"}},
    {Changes::Result, {"--effects", "all"}},
    {Changes::Result, {"--alpha"}},
    {Changes::Result, {"--outputs", "beauty"}},
    {Changes::Result, {"--compression", "piz"}},
    {Changes::Result, {"--dwa-level", "60"}, {}, {"-i", "in.exr", "-o", "out.exr", "--compression", "dwaa"}},
    {Changes::Result,
     {"--budget", "4"},
     {"--budget", "3"},
     {"-i", "in.exr", "-o", "out.exr", "--sample-map", "map.exr"}},
    {Changes::Result, {"--target", "0.01"}},
    {Changes::Result, {"--max-samples", "8"}, {}, with_map},
    {Changes::Result, {"--cost", "cost.exr"}, {}, with_map},
    {Changes::Result, {"--frame", "7"}, {}, with_map},
    {Changes::Result, {"--seed", "7"}, {}, with_map},
    {Changes::Result, {"--export", "vray"}, {}, with_map},
    {Changes::Run, {"--threads", "1"}},
    {Changes::Run, {"--max-memory", "1G"}},
    {Changes::Run, {"--progress", "json"}},
    {Changes::Run, {"--overwrite"}},
    {Changes::Run, {"--on-miss", "fail"}},
    {Changes::Run, {"--quiet"}},
    {Changes::Run, {"--verbose"}},
    {Changes::Run, {"--max-pixels", "10000"}},
    {Changes::Run, {"--max-channels", "10"}},
};

TEST(Identity, EveryOptionIsInTheTable) {
  std::multiset<std::string> known{"--help"};  // CLI11's own
  for (const OptionCase& c : cases) known.insert(c.with.front());
  EXPECT_EQ(CommandLine(file).option_names(), known);
}

TEST(Identity, DependsOnEveryOptionThatChangesTheResultAndOnNoOther) {
  for (const OptionCase& c : cases) {
    const std::string with = job_of(c.with, c.base).settings, without = job_of(c.without, c.base).settings;
    EXPECT_EQ(with != without, c.changes == Changes::Result) << c.with.front() << ": " << with << " and " << without;
  }
}

TEST(Identity, ADefaultThatIsGivenChangesNothing) {
  const std::string plain = job_of({}).settings;
  for (const Words& words : std::vector<Words>{
           {"--quality", "standard"}, {"--stages", "2"}, {"--order", "2"}, {"--steps", "auto"}, {"--outputs", "input"}})
    EXPECT_EQ(job_of(words).settings, plain) << words[0];
  EXPECT_EQ(job_of({"--max-samples", "1e3"}, with_map).settings,
            job_of({"--max-samples", "1000.0"}, with_map).settings);
  EXPECT_EQ(job_of({"--frame-radius", "2"}, sequence).settings, job_of({}, sequence).settings);
  EXPECT_NE(job_of({"--frame-radius", "0"}, sequence).settings, job_of({}, sequence).settings);
}

TEST(Identity, TwoNamesOfOneOptionAreTheSame) {
  EXPECT_EQ(job_of({"--prior", "A"}).settings, job_of({"--map", "prior=A"}).settings);
  EXPECT_EQ(job_of({"--effects", "all"}).settings, job_of({"--steps", "all"}).settings);
}

TEST(Denoisers, AreNamedByThePrior) {
  EXPECT_EQ(job_of({}).make_denoiser, nullptr);
  EXPECT_EQ(job_of({"--prior", "Denoised"}).make_denoiser, nullptr);
  const Job job = job_of({"--prior", "oidn"});
  EXPECT_NE(job.make_denoiser, nullptr);
  EXPECT_TRUE(job.read.map.empty()) << "oidn is no layer";
  EXPECT_NE(job.settings, job_of({}).settings);
}

TEST(Denoisers, ExcludeWhatContradictsThem) {
  for (const Words& words :
       std::vector<Words>{{"--prior", "oidn", "--map", "prior=Denoised"}, {"--oidn", "/lib"}, {"--oidn-device", "cpu"}})
    try {
      job_of(words);
      FAIL() << words[0] << ' ' << words[1];
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::Usage);
    }
}

TEST(Identity, NamesTheSettingsThatHold) {
  EXPECT_THAT(job_of({"--quality", "draft"}).settings, ::testing::HasSubstr("--quality draft --stages 1 --order 1"));
  EXPECT_THAT(job_of({"--steps", "albedo"}).settings, ::testing::HasSubstr("--stages 1"));
  // Those that a pilot chooses are not known yet.
  EXPECT_EQ(job_of({"--time-budget", "5"}).settings, "--frame-radius 0 --time-budget 5");
}

TEST(Identity, ReadsAsACommandLine) {
  const Job job = job_of({"--aov", "it's", "--view-layer", "A B", "--map", "albedo=X"});
  EXPECT_THAT(job.settings, ::testing::HasSubstr(R"(--aov 'it'\''s' --map albedo=X --view-layer 'A B')"));
}

TEST(Identity, OfASampleMapHasTheNumberOfTheFrame) {
  const Job plain = job_of({}, sequence);
  EXPECT_EQ(settings_of(plain, plain.frames[0]), settings_of(plain, plain.frames[1]));
  const Job job = job_of({"--sample-map", "map.####.exr", "--budget", "4"}, sequence);
  EXPECT_EQ(settings_of(job, job.frames[1]), job.settings + " --frame 2");
}

TEST(Job, ResolvesTheFilesOfASequence) {
  const Job job = job_of({"--error-map", "e/####.exr", "--frame-radius", "1"}, sequence);
  EXPECT_TRUE(job.is_sequence);
  ASSERT_EQ(job.frames.size(), 3u);
  const FrameFiles& last = job.frames[2];
  EXPECT_EQ(last.input, "shot.0003.exr");
  EXPECT_EQ(last.outputs.picture, "out.0003.exr");
  EXPECT_EQ(last.outputs.error_map, "e/0003.exr");
  EXPECT_TRUE(last.outputs.report.empty());
  ASSERT_EQ(last.neighbours.size(), 2u);
  EXPECT_EQ(last.neighbours[0].path, "shot.0002.exr");
  EXPECT_TRUE(last.neighbours[0].is_denoised_too);
  EXPECT_EQ(last.neighbours[1].path, "shot.0004.exr");
  EXPECT_FALSE(last.neighbours[1].is_denoised_too);
  EXPECT_EQ(job.params.temporal.radius, 1);
  EXPECT_TRUE(job.read.motion);
}

TEST(Job, OneFileHasNoNeighbours) {
  const Job job = job_of({});
  EXPECT_FALSE(job.is_sequence);
  ASSERT_EQ(job.frames.size(), 1u);
  EXPECT_TRUE(job.frames[0].neighbours.empty());
  EXPECT_EQ(job.params.temporal.radius, 0);
  EXPECT_FALSE(job.read.motion);
}

TEST(Job, OptionsReplaceWhatTheQualitySets) {
  const Job job = job_of({"--quality", "best", "--stages", "1", "--order", "3", "--max-memory", "1G", "--alpha"});
  EXPECT_EQ(job.params.stages, 1);
  EXPECT_EQ(job.params.max_order, 3);
  EXPECT_EQ(job.params.radius, params_for(Quality::Best).radius);
  EXPECT_EQ(job.params.max_memory, std::size_t{1} << 30);
  EXPECT_TRUE(job.params.reconstruct_alpha);
  EXPECT_FALSE(job.limits);
}

TEST(Job, ATargetChoosesSettingsOnlyWithoutASampleMap) {
  const Job chosen = job_of({"--target", "0.01", "--alpha", "--steps", "all"});
  ASSERT_TRUE(chosen.limits);
  EXPECT_EQ(chosen.limits->relative_mse, 0.01);
  EXPECT_FALSE(chosen.sample_map);
  ASSERT_EQ(chosen.presets.size(), preset_count);
  for (std::size_t p = 0; p < preset_count; ++p) {
    EXPECT_TRUE(chosen.presets[p].reconstruct_alpha);
    EXPECT_FALSE(chosen.presets[p].steps.decide);
    EXPECT_EQ(chosen.presets[p].stages, presets()[p].params.stages);
  }
  const Job mapped = job_of({"--target", "0.01", "--sample-map", "m.exr"});
  EXPECT_FALSE(mapped.limits);
  ASSERT_TRUE(mapped.sample_map);
  EXPECT_EQ(mapped.sample_map->params.target, 0.01);
}

TEST(Job, WhatIsLeftOfATimeLimitStillSelectsSettings) {
  EXPECT_DOUBLE_EQ((FrameLimits{10, 0.1}.after(4).seconds), 6);
  EXPECT_DOUBLE_EQ((FrameLimits{10, 0.1}.after(40).seconds), 1e-3);
  EXPECT_EQ((FrameLimits{0, 0.1}.after(40).seconds), 0);  // 0: no limit
  EXPECT_EQ((FrameLimits{10, 0.1}.after(40).relative_mse), 0.1);
}

}  // namespace
}  // namespace polyrecon
