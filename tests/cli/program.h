#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace polyrecon::testing {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A file as it is now: an ImageBuf that names its file would look into OpenImageIO's cache.
inline OIIO::ImageBuf load(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) throw std::runtime_error(path + ": " + OIIO::geterror());
  OIIO::ImageSpec spec = input->spec();
  spec.set_format(OIIO::TypeDesc::FLOAT);
  OIIO::ImageBuf buffer(spec);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, buffer.localpixels()))
    throw std::runtime_error(path + ": " + input->geterror());
  return buffer;
}

/// The program, and the library that makes its system calls fail, of this build.
const char* program_path();
const char* failing_calls_path();

/// What a run of the program left.
struct Outcome {
  int code = -1;  ///< Exit code; 128 + signal where one ended it.
  std::string out, err;
};

/// Runs the program itself, arguments as a list, in a folder of its own that is removed at the end.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("polyrecon-") + info->test_suite_name() + "-" +
                                                        info->name() + "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~ProgramTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  /// Names of all files in the folder, the caught output left out.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != "stdout" && name != "stderr") names.push_back(name);
    }
    return names;
  }

  pid_t start(const std::vector<std::string>& arguments) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int out = ::open(path("stdout").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    const int err = ::open(path("stderr").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    in_child_();
    std::vector<char*> argv{const_cast<char*>(program_path())};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    if (::chdir(folder_.c_str()) == 0) ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  Outcome finish(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(path("stdout")),
            read_text(path("stderr"))};
  }

  Outcome run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

  std::filesystem::path folder_;
  std::function<void()> in_child_ = [] {};  ///< Called in the child before the program, to set limits.
};

/// A file of float channels; value(x, y, channel).
template <typename Value>
void write_exr(const std::string& path, int width, int height, const std::vector<std::string>& channels, Value value) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = channels;
  OIIO::ImageBuf buffer(spec);
  std::vector<float> pixel(channels.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < channels.size(); ++c) pixel[c] = static_cast<float>(value(x, y, static_cast<int>(c)));
      buffer.setpixel(x, y, pixel.data());
    }
  ASSERT_TRUE(buffer.write(path)) << buffer.geterror();
}

/// A noisy ramp with an edge, as Blender names its layers: beauty, its variance and half buffers, albedo and depth.
inline void write_render(const std::string& path, int width = 40, int height = 24, unsigned seed = 1) {
  const std::string beauty = "ViewLayer.Combined";
  std::vector<std::string> channels;
  for (const char* suffix : {"", " Variance", " A", " B"})
    for (const char* c : {".R", ".G", ".B"}) channels.push_back(beauty + suffix + c);
  for (const char* c : {".R", ".G", ".B"}) channels.push_back(std::string("ViewLayer.Denoising Albedo") + c);
  channels.push_back("ViewLayer.Denoising Depth.Z");
  constexpr double sigma = 0.1;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma * std::sqrt(2.0));
  std::vector<double> a(3), b(3);
  write_exr(path, width, height, channels, [&](int x, int y, int c) {
    const double albedo = x < width / 2 ? 0.2 : 0.8;
    const double truth = albedo * (0.5 + static_cast<double>(y) / height);
    if (c == 0)
      for (std::size_t i = 0; i < 3; ++i) a[i] = truth + noise(random), b[i] = truth + noise(random);
    const auto i = static_cast<std::size_t>(c % 3);
    switch (c / 3) {
      case 0:
        return (a[i] + b[i]) / 2;
      case 1:
        return sigma * sigma;
      case 2:
        return a[i];
      case 3:
        return b[i];
      case 4:
        return albedo;
      default:
        return 5.0 + x;
    }
  });
}

/// One line, beginning as all errors of the program do.
inline ::testing::AssertionResult is_one_error_line(const std::string& text) {
  if (text.compare(0, 11, "polyrecon: ") != 0) return ::testing::AssertionFailure() << "begins otherwise: " << text;
  if (text.find('\n') != text.size() - 1) return ::testing::AssertionFailure() << "not one line: " << text;
  return ::testing::AssertionSuccess();
}

}  // namespace polyrecon::testing
