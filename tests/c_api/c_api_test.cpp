// The C interface as a host uses it: only polyrecon.h and the shared library.

#include <Imath/half.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "polyrecon/polyrecon.h"

namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string sample = std::string(POLYRECON_SAMPLES) + "/study_small_0.exr";

struct Release {
  void operator()(polyrecon_filter* filter) const { polyrecon_release_filter(filter); }
};
using Filter = std::unique_ptr<polyrecon_filter, Release>;

Filter filter_of(const char* kind) { return Filter(polyrecon_new_filter(kind)); }

std::string message_of(const Filter& filter) {
  const char* message = nullptr;
  polyrecon_get_error(filter.get(), &message);
  return message;
}

struct Pixels {
  int width = 0, height = 0, channels = 0;
  std::vector<float> samples;

  polyrecon_image image() const {
    return {const_cast<float*>(samples.data()), POLYRECON_FLOAT, width, height, channels, 0, 0, 0};
  }
};

Pixels take(const Filter& filter, const char* name) {
  polyrecon_image image{};
  EXPECT_EQ(polyrecon_describe_image(filter.get(), name, &image), POLYRECON_OK) << message_of(filter);
  Pixels pixels{image.width, image.height, image.channels, {}};
  pixels.samples.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                        static_cast<std::size_t>(image.channels));
  const polyrecon_image target = pixels.image();
  EXPECT_EQ(polyrecon_get_image(filter.get(), name, &target), POLYRECON_OK) << message_of(filter);
  return pixels;
}

/// The images of a file with their names.
std::vector<std::pair<std::string, Pixels>> read(const std::string& path) {
  const Filter filter = filter_of("read");
  polyrecon_set_text(filter.get(), "input", path.c_str());
  EXPECT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
  std::vector<std::pair<std::string, Pixels>> images;
  for (int i = 0; i < polyrecon_image_count(filter.get()); ++i) {
    const std::string name = polyrecon_image_name(filter.get(), i);
    images.emplace_back(name, take(filter, name.c_str()));
  }
  return images;
}

const Pixels& named(const std::vector<std::pair<std::string, Pixels>>& images, const std::string& name) {
  for (const auto& image : images)
    if (image.first == name) return image.second;
  throw std::runtime_error("no image " + name);
}

/// A filter "denoise" at draft quality with the images of the sample; they must outlive it.
Filter denoiser_of(const std::vector<std::pair<std::string, Pixels>>& images) {
  Filter filter = filter_of("denoise");
  polyrecon_set_text(filter.get(), "quality", "draft");
  for (const auto& [name, pixels] : images) {
    const polyrecon_image image = pixels.image();
    EXPECT_EQ(polyrecon_set_image(filter.get(), name.c_str(), &image), POLYRECON_OK) << message_of(filter);
  }
  return filter;
}

class CApiTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "polyreconXXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// A render that is stored as floats: a file of half floats would round the result.
  std::string merged_sample() const {
    const Filter merge = filter_of("merge");
    for (const char* name : {"study_small_0.exr", "study_small_1.exr"})
      polyrecon_set_text(merge.get(), "input", (std::string(POLYRECON_SAMPLES) + "/" + name).c_str());
    polyrecon_set_text(merge.get(), "output", path("floats.exr").c_str());
    EXPECT_EQ(polyrecon_execute(merge.get()), POLYRECON_OK) << message_of(merge);
    return path("floats.exr");
  }

  /// The result of the program at draft quality.
  Pixels by_program(const std::string& noisy) const {
    const std::string clean = path("clean.exr");
    const std::string command =
        std::string("'") + POLYRECON_PROGRAM + "' denoise -q --quality draft -i '" + noisy + "' -o '" + clean + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return named(read(clean), "beauty");
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(CApiTest, SeveralThreadsAtOnceMakeTheBitsOfTheProgram) {
  const std::string noisy = merged_sample();
  const auto images = read(noisy);
  const Pixels expected = by_program(noisy);
  EXPECT_NE(expected.samples, named(images, "beauty").samples);
  std::vector<std::vector<float>> results(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); ++i)
    threads.emplace_back([&, i] {
      const Filter filter = denoiser_of(images);
      polyrecon_set_number(filter.get(), "threads", static_cast<double>(i));
      ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
      results[i] = take(filter, "result").samples;
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, expected.samples);
}

TEST_F(CApiTest, AFileIsDenoisedAsByTheProgram) {
  const std::string noisy = merged_sample();
  const Filter filter = filter_of("denoise");
  polyrecon_set_text(filter.get(), "quality", "draft");
  polyrecon_set_text(filter.get(), "input", noisy.c_str());
  polyrecon_set_text(filter.get(), "output", path("ours.exr").c_str());
  polyrecon_set_number(filter.get(), "budget", 8);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
  EXPECT_EQ(named(read(path("ours.exr")), "beauty").samples, by_program(noisy).samples);
  const auto report = nlohmann::json::parse(polyrecon_get_report(filter.get()));
  const Pixels error = take(filter, "relmse");
  double sum = 0;
  for (const float e : error.samples) sum += static_cast<double>(e);
  EXPECT_NEAR(report.at("estimated_relmse").get<double>(), sum / static_cast<double>(error.samples.size()),
              1e-6 * report.at("estimated_relmse").get<double>());
  const Pixels samples = take(filter, "samples");
  double total = 0;
  for (const float s : samples.samples) total += static_cast<double>(s);
  EXPECT_NEAR(total / static_cast<double>(samples.samples.size()), 8, 1e-3);
}

TEST_F(CApiTest, TheFileSaysWhichParametersTheResultDependsOn) {
  const Filter filter = filter_of("denoise");
  polyrecon_set_text(filter.get(), "quality", "draft");
  polyrecon_set_text(filter.get(), "map", "albedo=ViewLayer.Denoising Albedo");
  polyrecon_set_text(filter.get(), "input", sample.c_str());
  polyrecon_set_text(filter.get(), "output", path("clean.exr").c_str());
  polyrecon_set_number(filter.get(), "samples", 16);
  polyrecon_set_number(filter.get(), "wrap", 0);
  polyrecon_set_number(filter.get(), "threads", 1);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
  const Imf::MultiPartInputFile file(path("clean.exr").c_str());
  EXPECT_EQ(file.header(0).typedAttribute<Imf::StringAttribute>("polyrecon/settings").value(),
            "library: map 'albedo=ViewLayer.Denoising Albedo', quality 'draft', samples '16'");
}

TEST_F(CApiTest, TheHostsFloatingPointModeChangesNothing) {
  const auto images = read(sample);
  const Filter filter = denoiser_of(images);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK);
  const auto expected = take(filter, "result").samples;
  constexpr unsigned flush_to_zero_round_up = 0x8040U | 0x4000U;
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | flush_to_zero_round_up);
  const polyrecon_error error = polyrecon_execute(filter.get());
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  ASSERT_EQ(error, POLYRECON_OK);
  EXPECT_EQ(after & 0xffc0U, (before | flush_to_zero_round_up) & 0xffc0U) << "the host's mode was not restored";
  EXPECT_EQ(take(filter, "result").samples, expected);
}

TEST_F(CApiTest, StridesOfAnyKindAreRead) {
  const auto images = read(sample);
  const Pixels& beauty = named(images, "beauty");
  const Filter filter = denoiser_of(images);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK);
  const auto expected = take(filter, "result");
  // The same picture as planes that are stored bottom-up, at an odd address.
  const auto width = static_cast<std::size_t>(beauty.width), height = static_cast<std::size_t>(beauty.height);
  std::vector<std::byte> bytes(1 + 3 * width * height * sizeof(float));
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        std::memcpy(&bytes[1 + ((c * height + height - 1 - y) * width + x) * sizeof(float)],
                    &beauty.samples[(y * width + x) * 3 + c], sizeof(float));
  const auto stride = [](std::size_t samples) { return static_cast<std::ptrdiff_t>(samples * sizeof(float)); };
  const polyrecon_image planes{&bytes[1 + (height - 1) * width * sizeof(float)],
                               POLYRECON_FLOAT,
                               beauty.width,
                               beauty.height,
                               3,
                               stride(width * height),
                               stride(1),
                               -stride(width)};
  ASSERT_EQ(polyrecon_set_image(filter.get(), "beauty", &planes), POLYRECON_OK) << message_of(filter);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
  EXPECT_EQ(take(filter, "result").samples, expected.samples);
  ASSERT_EQ(polyrecon_get_image(filter.get(), "result", &planes), POLYRECON_OK) << message_of(filter);
  float first = 0;
  std::memcpy(&first, planes.data, sizeof first);
  EXPECT_EQ(first, expected.samples[0]);
}

TEST_F(CApiTest, HalfSamplesAreReadAndWritten) {
  const int width = 32, height = 24;
  std::vector<half> noisy(3 * width * height);
  for (std::size_t i = 0; i < noisy.size(); ++i) noisy[i] = half(0.5F + 0.01F * static_cast<float>(i * 37 % 11));
  noisy[3 * (12 * width + 16)] = half::posInf();
  polyrecon_image image{noisy.data(), POLYRECON_HALF, width, height, 3, 0, 0, 0};
  const Filter filter = filter_of("denoise");
  ASSERT_EQ(polyrecon_set_image(filter.get(), "beauty", &image), POLYRECON_OK);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << message_of(filter);
  const auto notes = nlohmann::json::parse(polyrecon_get_report(filter.get())).at("notes");
  ASSERT_EQ(notes.size(), 1U);  // on the lone +Inf
  EXPECT_THAT(notes.at(0).get<std::string>(), HasSubstr("beauty"));
  ASSERT_EQ(polyrecon_get_image(filter.get(), "result", &image), POLYRECON_OK);
  for (const half value : noisy) {
    EXPECT_GT(static_cast<float>(value), 0.3F);
    EXPECT_LT(static_cast<float>(value), 0.8F);
  }
}

TEST_F(CApiTest, ProgressArrivesInOrderAndStopsTheWork) {
  struct Seen {
    std::string phase;
    double done = 0;
    int calls = 0, inside = 0, overlaps = 0, backwards = 0;
    bool stop = false;
  };
  const auto watch = [](void* user, const char* phase, double done) {
    auto& seen = *static_cast<Seen*>(user);
    seen.overlaps += seen.inside++ > 0;
    if (seen.phase == phase && done < seen.done) ++seen.backwards;
    seen.phase = phase;
    seen.done = done;
    ++seen.calls;
    --seen.inside;
    return seen.stop ? 0 : 1;
  };
  const auto images = read(sample);
  const Filter filter = denoiser_of(images);
  Seen seen;
  polyrecon_set_progress(filter.get(), watch, &seen);
  ASSERT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK);
  EXPECT_GT(seen.calls, 4);
  EXPECT_EQ(seen.overlaps, 0);
  EXPECT_EQ(seen.done, 1);
  seen.stop = true;
  EXPECT_EQ(polyrecon_execute(filter.get()), POLYRECON_INTERRUPTED);
  EXPECT_EQ(polyrecon_image_count(filter.get()), 0);
  EXPECT_STREQ(polyrecon_get_report(filter.get()), "");
  polyrecon_set_progress(filter.get(), nullptr, nullptr);
  EXPECT_EQ(polyrecon_execute(filter.get()), POLYRECON_OK) << "an interrupted filter can be used again";
}

TEST_F(CApiTest, MistakesHaveACodeAndALineThatSaysWhat) {
  const auto images = read(sample);
  struct Mistake {
    std::function<void(polyrecon_filter*)> make;
    polyrecon_error error;
    std::string message;
  };
  const Pixels& beauty = named(images, "beauty");
  Pixels small{8, 8, 3, std::vector<float>(192)};
  const auto with_image = [](const char* name, polyrecon_image image) {
    return [name, image](polyrecon_filter* filter) { polyrecon_set_image(filter, name, &image); };
  };
  const auto with_text = [](const char* name, const char* value) {
    return [name, value](polyrecon_filter* filter) { polyrecon_set_text(filter, name, value); };
  };
  const auto with_number = [](const char* name, double value) {
    return [name, value](polyrecon_filter* filter) { polyrecon_set_number(filter, name, value); };
  };
  auto changed = [&](const auto& change) {
    polyrecon_image image = beauty.image();
    change(image);
    return image;
  };
  const std::vector<Mistake> mistakes{
      {with_image("colour", beauty.image()), POLYRECON_USAGE, "no image 'colour'; there are: beauty"},
      {with_image("beauty", changed([](auto& i) { i.channels = 4; })), POLYRECON_USAGE, "has 4 channels, 3 are needed"},
      {with_image("beauty", changed([](auto& i) { i.width = -1; })), POLYRECON_USAGE, "has -1 x"},
      {with_image("beauty", changed([](auto& i) { i.width = 1 << 30; })), POLYRECON_USAGE, "more than the limit"},
      {with_image("beauty", changed([](auto& i) { i.format = static_cast<polyrecon_format>(3); })), POLYRECON_USAGE,
       "neither float nor half"},
      {with_image("beauty", changed([](auto& i) { i.pixel_stride = 12; })), POLYRECON_USAGE, "strides"},
      {with_image("albedo", small.image()), POLYRECON_USAGE, "image 'albedo': has 8 x 8 pixels, the beauty has"},
      {with_image("beauty A", beauty.image()), POLYRECON_USAGE, "give both, or none"},
      {with_image("visibility variance", beauty.image()), POLYRECON_USAGE, "no image 'visibility'"},
      {with_image("beauty", {}), POLYRECON_USAGE, "there is no image 'beauty'"},
      {with_text("quality", "superb"), POLYRECON_USAGE, "quality 'superb'"},
      {with_text("kwality", "draft"), POLYRECON_USAGE, "no parameter 'kwality'; there are: "},
      {with_text("threads", "2"), POLYRECON_USAGE, "is a number"},
      {with_number("quality", 1), POLYRECON_USAGE, "is a text"},
      {with_number("stages", 2.5), POLYRECON_USAGE, "'stages': 2.5 is no whole number"},
      {with_number("order", 9), POLYRECON_USAGE, "between"},
      {with_number("alpha", std::numeric_limits<double>::quiet_NaN()), POLYRECON_USAGE, "not finite"},
      {with_text("input", "render.exr"), POLYRECON_USAGE, "take one of them away"},
      {with_text("output", "clean.exr"), POLYRECON_USAGE, "the filter 'write'"},
      {with_text("prior", "magic"), POLYRECON_USAGE, "no denoiser 'magic'"},
      {with_image("aov ", beauty.image()), POLYRECON_USAGE, "no image 'aov '"},
      {with_number("max memory", 1e6), POLYRECON_OUT_OF_MEMORY, "needs 'max memory' "},
  };
  for (const Mistake& mistake : mistakes) {
    const Filter filter = denoiser_of(images);
    mistake.make(filter.get());
    if (polyrecon_get_error(filter.get(), nullptr) == POLYRECON_OK) polyrecon_execute(filter.get());
    const std::string message = message_of(filter);
    EXPECT_EQ(polyrecon_get_error(filter.get(), nullptr), mistake.error) << mistake.message << ": " << message;
    EXPECT_THAT(message, HasSubstr(mistake.message));
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_EQ(polyrecon_image_count(filter.get()), 0) << message;
  }
}

TEST_F(CApiTest, MessagesNameParametersWhereThoseOfTheProgramNameOptions) {
  const Filter read = filter_of("read");
  polyrecon_set_text(read.get(), "input", sample.c_str());
  polyrecon_set_text(read.get(), "map", "colour=Layer");
  EXPECT_EQ(polyrecon_execute(read.get()), POLYRECON_USAGE);
  EXPECT_THAT(message_of(read), StartsWith("'map' colour=Layer: expected ROLE=LAYER"));

  std::vector<float> grey(16 * 16 * 3, 0.5F);
  const Filter denoise = filter_of("denoise");
  const polyrecon_image beauty{grey.data(), POLYRECON_FLOAT, 16, 16, 3, 0, 0, 0};
  polyrecon_set_image(denoise.get(), "beauty", &beauty);
  EXPECT_EQ(polyrecon_execute(denoise.get()), POLYRECON_OK);
  EXPECT_THAT(polyrecon_get_report(denoise.get()), HasSubstr("give 'samples'"));
}

TEST_F(CApiTest, FilesThatAreMissingOrDamagedAreRefused) {
  for (const auto& [name, error] : {std::pair<const char*, polyrecon_error>{"missing.exr", POLYRECON_MISSING},
                                    {"empty.exr", POLYRECON_BAD_INPUT}}) {
    if (error == POLYRECON_BAD_INPUT) std::fclose(std::fopen(path(name).c_str(), "w"));
    const Filter filter = filter_of("read");
    polyrecon_set_text(filter.get(), "input", path(name).c_str());
    EXPECT_EQ(polyrecon_execute(filter.get()), error);
    EXPECT_THAT(message_of(filter), HasSubstr(name));
  }
  const Filter filter = denoiser_of({});
  polyrecon_set_text(filter.get(), "input", sample.c_str());
  polyrecon_set_text(filter.get(), "output", "/dev/null/clean.exr");
  EXPECT_EQ(polyrecon_execute(filter.get()), POLYRECON_CANNOT_WRITE);
  polyrecon_set_text(filter.get(), "output", path("clean.png").c_str());
  EXPECT_EQ(polyrecon_execute(filter.get()), POLYRECON_USAGE);
}

TEST_F(CApiTest, NullIsAMistakeAndNoCrash) {
  EXPECT_EQ(polyrecon_new_filter("magic"), nullptr);
  EXPECT_EQ(polyrecon_new_filter(nullptr), nullptr);
  polyrecon_release_filter(nullptr);
  EXPECT_EQ(polyrecon_execute(nullptr), POLYRECON_USAGE);
  EXPECT_STREQ(polyrecon_get_report(nullptr), "");
  EXPECT_EQ(polyrecon_image_count(nullptr), 0);
  const Filter filter = filter_of("denoise");
  EXPECT_EQ(polyrecon_set_image(filter.get(), nullptr, nullptr), POLYRECON_USAGE);
  EXPECT_EQ(polyrecon_set_text(filter.get(), nullptr, nullptr), POLYRECON_USAGE);
  EXPECT_EQ(polyrecon_describe_image(filter.get(), "result", nullptr), POLYRECON_MISSING);
  EXPECT_EQ(polyrecon_image_name(filter.get(), 0), nullptr);
}

TEST_F(CApiTest, MergedRendersAndTheirSampleMap) {
  const Filter merge = filter_of("merge");
  for (const char* name : {"study_small_0.exr", "study_small_1.exr", "study_small_2.exr"})
    polyrecon_set_text(merge.get(), "input", (std::string(POLYRECON_SAMPLES) + "/" + name).c_str());
  polyrecon_set_text(merge.get(), "output", path("merged.exr").c_str());
  polyrecon_set_number(merge.get(), "samples", 4);
  ASSERT_EQ(polyrecon_execute(merge.get()), POLYRECON_OK) << message_of(merge);
  EXPECT_EQ(nlohmann::json::parse(polyrecon_get_report(merge.get())).at("samples"), 12);
  const auto images = read(path("merged.exr"));
  const Pixels &mean = named(images, "beauty"), &a = named(images, "beauty A"), &b = named(images, "beauty B");
  EXPECT_EQ(named(images, "beauty variance").samples.size(), mean.samples.size());
  for (std::size_t i = 0; i < mean.samples.size(); i += 101)  // two renders are half A, one is half B
    EXPECT_NEAR(mean.samples[i], (2 * a.samples[i] + b.samples[i]) / 3, 1e-3F * (1 + mean.samples[i]));
  const Filter denoise = denoiser_of(images);
  ASSERT_EQ(polyrecon_execute(denoise.get()), POLYRECON_OK) << message_of(denoise);
  const Filter map = filter_of("sample map");
  std::vector<Pixels> maps;
  for (const char* name : {"relmse", "relvariance", "relnoise"}) maps.push_back(take(denoise, name));
  std::size_t next = 0;
  for (const char* name : {"relmse", "relvariance", "relnoise"}) {
    const polyrecon_image image = maps[next++].image();
    ASSERT_EQ(polyrecon_set_image(map.get(), name, &image), POLYRECON_OK) << message_of(map);
  }
  EXPECT_EQ(polyrecon_execute(map.get()), POLYRECON_USAGE) << "neither budget nor target";
  polyrecon_set_number(map.get(), "budget", 16);
  polyrecon_set_number(map.get(), "samples", 12);
  ASSERT_EQ(polyrecon_execute(map.get()), POLYRECON_OK) << message_of(map);
  const Pixels samples = take(map, "samples");
  double total = 0;
  for (const float s : samples.samples) total += static_cast<double>(s);
  EXPECT_NEAR(total / static_cast<double>(samples.samples.size()), 16, 1e-3);
}

TEST_F(CApiTest, NothingIsPrinted) {
  std::fflush(stdout);
  const int file = ::open(path("printed").c_str(), O_RDWR | O_CREAT, 0600);
  const int out = ::dup(1), err = ::dup(2);
  ::dup2(file, 1);
  ::dup2(file, 2);
  const auto images = read(sample);
  const Filter filter = denoiser_of(images);
  const polyrecon_error done = polyrecon_execute(filter.get());
  polyrecon_set_text(filter.get(), "quality", "superb");
  const polyrecon_error failed = polyrecon_execute(filter.get());
  ::dup2(out, 1);
  ::dup2(err, 2);
  for (const int descriptor : {file, out, err}) ::close(descriptor);
  EXPECT_EQ(done, POLYRECON_OK);
  EXPECT_EQ(failed, POLYRECON_USAGE);
  EXPECT_EQ(std::filesystem::file_size(path("printed")), 0U);
}

}  // namespace
