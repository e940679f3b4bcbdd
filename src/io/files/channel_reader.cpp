#include "io/files/channel_reader.h"

#include <Iex.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "core/first_line.h"
#include "io/exr/out_of_memory.h"
#include "io/files/plain_image_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr std::size_t band_samples = std::size_t{1} << 24;
constexpr int tallest_chunk = 256;
constexpr std::size_t most_lines = std::size_t{1} << 20;

[[noreturn]] void fail(const FileInfo& file, int part, const std::string& what) {
  throw Error(ExitCode::BadInput, fmt::format("{}: {} {}", file.path, title_of(file, part), what));
}

}  // namespace

/// An open EXR file, or all pixels of a plain image.
struct ChannelReader::Source {
  std::unique_ptr<Imf::MultiPartInputFile> container;
  std::unique_ptr<Imf::InputPart> input;
  Image pixels;
};

ChannelReader::ChannelReader(const FileInfo& file, int part, std::vector<std::string> channels)
    : source_(std::make_unique<Source>()), file_(file), part_(part), channels_(std::move(channels)) {
  if (const std::string obstacle = file.parts[static_cast<std::size_t>(part)].obstacle(); !obstacle.empty())
    fail(file, part, "is " + obstacle);
  if (file.format != "openexr") {
    source_->pixels = read_plain_image(file, channels_);
    return;
  }
  try {
    source_->container = std::make_unique<Imf::MultiPartInputFile>(file.path.c_str(), Imf::globalThreadCount(), false);
    source_->input = std::make_unique<Imf::InputPart>(*source_->container, part);
  } catch (const Iex::BaseExc& problem) {
    throw_if_out_of_memory(problem);
    fail(file, part, fmt::format("cannot be read: incomplete or damaged ({})", first_line(problem.what())));
  }
}

ChannelReader::~ChannelReader() = default;

int ChannelReader::lines_per_band() const {
  const Rect& window = file_.parts[static_cast<std::size_t>(part_)].data_window;
  const std::size_t line = std::max<std::size_t>(1, static_cast<std::size_t>(window.width()) * channels_.size());
  return std::max(tallest_chunk, static_cast<int>(std::min(band_samples / line, most_lines)));
}

const std::vector<float>& ChannelReader::read(int y0, int y1) {
  const Rect& window = file_.parts[static_cast<std::size_t>(part_)].data_window;
  const auto width = static_cast<std::size_t>(window.width());
  const std::size_t plane = width * static_cast<std::size_t>(y1 - y0);
  band_.resize(plane * channels_.size());
  if (!source_->input) {
    for (std::size_t c = 0; c < channels_.size(); ++c)
      std::transform(source_->pixels.row(static_cast<int>(c), y0 - window.y0),
                     source_->pixels.row(static_cast<int>(c), y0 - window.y0) + plane,
                     band_.begin() + static_cast<std::ptrdiff_t>(plane * c),
                     [](Real v) { return static_cast<float>(v); });
    return band_;
  }
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels_.size(); ++c)
    buffer.insert(channels_[c], Imf::Slice::Make(Imf::FLOAT, band_.data() + c * plane, Imath::V2i(window.x0, y0),
                                                 window.width(), y1 - y0, sizeof(float), sizeof(float) * width));
  source_->input->setFrameBuffer(buffer);
  try {
    source_->input->readPixels(y0, y1 - 1);
  } catch (const Iex::BaseExc& problem) {
    throw_if_out_of_memory(problem);
    int bad = y0;  // the library names the chunk at best, so the line is found by reading line by line
    try {
      for (; bad < y1; ++bad) source_->input->readPixels(bad);
    } catch (const Iex::BaseExc&) {
    }
    fail(file_, part_,
         fmt::format("cannot be read at scanline {}: incomplete or damaged ({})", std::min(bad, y1 - 1),
                     first_line(problem.what())));
  }
  return band_;
}

void read_bands(const FileInfo& file, int part, const std::vector<std::string>& channels,
                const std::function<void(const Band&)>& each) {
  const Rect& window = file.parts[static_cast<std::size_t>(part)].data_window;
  const auto width = static_cast<std::size_t>(window.width());
  ChannelReader reader(file, part, channels);
  const int lines = reader.lines_per_band();
  for (int y = window.y0, end = y; y < window.y1; y = end) {
    end = y + std::min(lines, window.y1 - y);
    each({width * static_cast<std::size_t>(y - window.y0), width * static_cast<std::size_t>(end - y),
          reader.read(y, end)});
  }
}

}  // namespace polyrecon
