#include "io/exr/file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>

#include "core/first_line.h"
#include "core/parallel.h"
#include "io/channel_reader.h"
#include "io/exr/attributes.h"
#include "io/exr/chunks.h"
#include "io/exr/compression.h"
#include "io/exr/guard.h"
#include "io/plain_image_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ExitCode::BadInput, fmt::format("{}: {}", path, what));
}

Rect to_rect(const Imath::Box2i& box) { return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1}; }

SampleType to_sample_type(Imf::PixelType type) {
  if (type == Imf::HALF) return SampleType::Half;
  return type == Imf::UINT ? SampleType::Uint : SampleType::Float;
}

PartInfo describe_part(const Imf::Header& header) {
  PartInfo part;
  if (header.hasName()) part.name = header.name();
  if (header.hasView()) part.view = header.view();
  part.data_window = to_rect(header.dataWindow());
  part.display_window = to_rect(header.displayWindow());
  part.compression = compression_name(header.compression());
  part.deep = header.hasType() && Imf::isDeepData(header.type());
  part.tiled = header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
  part.mipmapped = part.tiled && header.tileDescription().mode != Imf::ONE_LEVEL;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    part.channels.push_back({c.name(), to_sample_type(c.channel().type), c.channel().xSampling, c.channel().ySampling});
  if (Imf::hasMultiView(header)) part.views = Imf::multiView(header);
  for (auto a = header.begin(); a != header.end(); ++a)
    part.attributes.push_back({a.name(), a.attribute().typeName(), attribute_text(a.attribute())});
  return part;
}

bool begins_with_zeros(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::array<char, 8> head{};
  stream.read(head.data(), head.size());
  return std::all_of(head.begin(), head.begin() + stream.gcount(), [](char c) { return c == 0; });
}

std::uint64_t size_of_existing(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) throw Error(ExitCode::Missing, fmt::format("{}: no such file", path));
  if (!std::filesystem::is_regular_file(path, failure)) fail(path, "not a file");
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure || !std::ifstream(path, std::ios::binary)) fail(path, "cannot be opened for reading");
  if (bytes == 0 || begins_with_zeros(path)) fail(path, "not yet rendered: the file has no contents");
  return bytes;
}

void describe_exr(FileInfo& file, const ReadLimits& limits) {
  const std::uint64_t table_begin = check_attribute_sizes(file.path, file.bytes);
  std::vector<Imf::Header> headers;
  try {
    Imf::MultiPartInputFile input(file.path.c_str(), 0, false);
    for (int p = 0; p < input.parts(); ++p) headers.push_back(input.header(p));
  } catch (const std::exception& problem) {
    fail(file.path, fmt::format("incomplete or damaged header ({})", first_line(problem.what())));
  }
  check_claims(file.path, file.bytes, headers, limits);
  check_chunks(file.path, file.bytes, table_begin, headers);
  file.format = "openexr";
  for (const Imf::Header& header : headers) file.parts.push_back(describe_part(header));
}

/// Linear formats that renderers write; others are refused by name rather than guessed at.
bool is_plain_image(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static constexpr std::array known{".pfm", ".hdr", ".tif", ".tiff"};
  return std::find(known.begin(), known.end(), extension) != known.end();
}

}  // namespace

std::string PartInfo::obstacle() const {
  if (deep) return "deep (any number of samples in a pixel), which is unsupported; save a flat image";
  if (mipmapped) return "mip-mapped or ripmapped, which is unsupported; save one level";
  const auto subsampled = std::find_if(channels.begin(), channels.end(),
                                       [](const ChannelInfo& c) { return c.x_sampling != 1 || c.y_sampling != 1; });
  if (subsampled == channels.end()) return {};
  return fmt::format(
      "subsampled (channel {} has a sample for {} x {} pixels, as in luminance-chroma images), which is unsupported; "
      "save "
      "R, G and B of every pixel",
      subsampled->name, subsampled->x_sampling, subsampled->y_sampling);
}

const char* name_of(SampleType type) {
  switch (type) {
    case SampleType::Uint:
      return "uint";
    case SampleType::Half:
      return "half";
    case SampleType::Float:
      break;
  }
  return "float";
}

std::string title_of(const FileInfo& file, int part) {
  const std::string& name = file.parts[static_cast<std::size_t>(part)].name;
  return name.empty() ? fmt::format("part {}", part) : fmt::format("part {} \"{}\"", part, name);
}

void set_codec_threads(int threads) { Imf::setGlobalThreadCount(threads); }

FileInfo describe_file(const std::string& path, const ReadLimits& limits) {
  FileInfo file;
  file.path = path;
  file.bytes = size_of_existing(path);
  if (Imf::isOpenExrFile(path.c_str()))
    describe_exr(file, limits);
  else if (!is_plain_image(path))
    fail(path, "not an OpenEXR file");
  else
    describe_plain_image(file, limits);
  return file;
}

Image read_channels(const FileInfo& file, int part, const std::vector<std::string>& channels,
                    const ReadLimits& limits) {
  const Rect window = file.parts[static_cast<std::size_t>(part)].data_window;
  if (window.area() * channels.size() > limits.max_bytes / sizeof(Real))
    throw Error(ExitCode::OutOfMemory,
                fmt::format("{}: {} channels of {} x {} pixels need more than the limit of {} MB", file.path,
                            channels.size(), window.width(), window.height(), limits.max_bytes >> 20));
  Image image(window.width(), window.height(), static_cast<int>(channels.size()));
  std::vector<Real*> planes;
  planes.reserve(channels.size());
  for (int c = 0; c < image.channels(); ++c) planes.push_back(image.plane(c));
  read_planes(file, part, channels, planes);
  return image;
}

void read_planes(const FileInfo& file, int part, const std::vector<std::string>& channels,
                 const std::vector<Real*>& planes) {
  read_bands(file, part, channels, [&](const Band& band) { copy_band(band, planes); });
}

void copy_band(const Band& band, const std::vector<Real*>& planes) {
  in_parallel(planes.size(), [&](std::size_t c) {
    std::copy_n(band.samples.begin() + static_cast<std::ptrdiff_t>(band.pixels * c), band.pixels,
                planes[c] + band.first_pixel);
  });
}

const AttributeInfo* find_attribute(const PartInfo& part, const std::string& name) {
  const auto found = std::find_if(part.attributes.begin(), part.attributes.end(),
                                  [&](const AttributeInfo& a) { return a.name == name; });
  return found == part.attributes.end() ? nullptr : &*found;
}

}  // namespace polyrecon
