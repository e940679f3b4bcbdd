#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

const std::vector<std::string> commands{"denoise", "inspect", "merge", "samplemap", "preview", "compare"};

class Usage : public ProgramTest {};

TEST_F(Usage, EveryCommandHasHelpWithExamples) {
  for (const std::string& command : commands) {
    const Outcome o = run({command, "--help"});
    EXPECT_EQ(o.code, 0) << command;
    EXPECT_TRUE(o.err.empty()) << o.err;
    const std::size_t examples = o.out.find("Examples:");
    ASSERT_NE(examples, std::string::npos) << command;
    EXPECT_NE(o.out.find("polyrecon " + command + " ", examples), std::string::npos) << command;
  }
  const Outcome all = run({"--help"});
  EXPECT_EQ(all.code, 0);
  for (const std::string& command : commands) EXPECT_NE(all.out.find("\n  " + command), std::string::npos) << command;
}

TEST_F(Usage, TellsItsVersion) {
  const Outcome o = run({"--version"});
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.out.compare(0, 10, "polyrecon "), 0) << o.out;
}

TEST_F(Usage, UnknownCommandsAndOptionsAreUsageErrors) {
  std::vector<std::vector<std::string>> wrong{{}, {"clean"}, {"--nope"}};
  for (const std::string& command : commands) wrong.push_back({command, "--nope"});
  for (const std::string& command : commands) wrong.push_back({command});
  for (const auto& arguments : wrong) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.code, 2) << o.err;
    EXPECT_TRUE(is_one_error_line(o.err));
    EXPECT_TRUE(o.out.empty()) << o.out;
  }
}

TEST_F(Usage, NumbersHaveToBeFiniteAndAboveZero) {
  for (const char* number : {"nan", "inf", "0", "-3", "x"}) {
    const Outcome o = run({"denoise", "-i", "in.exr", "-o", "out.exr", "--samples", number});
    EXPECT_EQ(o.code, 2) << number;
    EXPECT_THAT(o.err, ::testing::HasSubstr(std::string(number) + " is no number above 0"));
  }
}

TEST_F(Usage, EveryOptionRefusesWhatIsNoNumber) {
  const std::vector<std::string> denoise{"denoise", "-i", "in.exr", "-o", "out.exr"},
      map{"samplemap", "-e", "error.exr", "-o", "samples.exr", "--budget", "4"};
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> calls{
      {denoise,
       {"--samples", "--frame-radius", "--wait", "--stages", "--order", "--time-budget", "--target", "--threads",
        "--max-memory", "--max-pixels", "--max-channels"}},
      {{"denoise", "-i", "in.exr", "-o", "out.exr", "--sample-map", "samples.exr", "--target", "1"},
       {"--max-samples", "--frame", "--seed"}},
      {{"inspect", "in.exr"}, {"--max-memory", "--max-pixels", "--max-channels"}},
      {{"merge", "in.exr", "other.exr", "-o", "out.exr"}, {"--samples", "--max-memory"}},
      {map, {"--samples", "--max-samples", "--frame", "--seed", "--max-memory"}},
      {{"preview", "in.exr", "-o", "out.png"}, {"--exposure", "--max-memory"}},
      {{"compare", "in.exr", "reference.exr"}, {"--exposure", "--max-memory"}},
      {{"sweep", "-i", "in.exr", "--reference", "r.exr", "-o", "page.html"}, {"--threads", "--max-memory"}}};
  for (const auto& [call, options] : calls)
    for (const std::string& option : options)
      for (const char* number : {"nan", "-nan", "inf", "-inf", "1e400", "1x", " "}) {
        std::vector<std::string> arguments = call;
        arguments.push_back(option + "=" + number);
        const Outcome o = run(arguments);
        EXPECT_EQ(o.code, 2) << option << "=" << number << ": " << o.err;
        EXPECT_TRUE(is_one_error_line(o.err)) << o.err;
        EXPECT_THAT(o.err, ::testing::HasSubstr(option)) << number;
      }
}

TEST_F(Usage, ResultsAreNotNamedAsOtherPictures) {
  testing::write_exr(path("in.exr"), 4, 4, {"R", "G", "B"}, [](int, int, int) { return 0.5; });
  const std::vector<std::vector<std::string>> calls{
      {"denoise", "-i", "in.exr", "-o", "out.PNG"},
      {"denoise", "-i", "in.exr", "-o", "out.exr", "--error-map", "map.tif"},
      {"merge", "in.exr", "in.exr", "-o", "out.jpg"}};
  for (const auto& call : calls) {
    const Outcome o = run(call);
    EXPECT_EQ(o.code, 2);
    EXPECT_THAT(o.err, ::testing::HasSubstr("an EXR file is written; give it the ending .exr"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.PNG")));
}

TEST_F(Usage, MissingFilesAreNamed) {
  const std::vector<std::vector<std::string>> all{{"denoise", "-i", "gone.exr", "-o", "out.exr"},
                                                  {"inspect", "gone.exr"},
                                                  {"merge", "gone.exr", "gone.exr", "-o", "out.exr"},
                                                  {"samplemap", "-e", "gone.exr", "--budget", "4", "-o", "out.exr"},
                                                  {"preview", "gone.exr", "-o", "out.png"},
                                                  {"compare", "gone.exr", "gone.exr"}};
  for (const auto& arguments : all) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.code, 4) << arguments[0];
    EXPECT_TRUE(is_one_error_line(o.err));
    EXPECT_NE(o.err.find("gone.exr"), std::string::npos) << o.err;
  }
  EXPECT_TRUE(files().empty());
}

TEST_F(Usage, DamagedFilesAreBadInput) {
  write_render(path("whole.exr"));
  const std::string whole = read_text(path("whole.exr"));
  std::ofstream(path("cut.exr"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  std::ofstream(path("empty.exr"), std::ios::binary).flush();
  std::ofstream(path("text.exr"), std::ios::binary) << "no picture at all\n";
  for (const std::string name : {"cut.exr", "empty.exr", "text.exr"}) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"denoise", "-i", name, "-o", "out.exr"},
                                                      {"preview", name, "-o", "out.png"},
                                                      {"compare", name, "whole.exr"}}) {
      const Outcome o = run(arguments);
      EXPECT_EQ(o.code, 3) << arguments[0] << " " << name << ": " << o.err;
      EXPECT_TRUE(is_one_error_line(o.err));
    }
  }
  EXPECT_FALSE(exists("out.exr"));
  EXPECT_FALSE(exists("out.png"));
}

}  // namespace
}  // namespace polyrecon::testing
