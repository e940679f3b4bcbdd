#include "io/files/file.h"

#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/bad_file.h"
#include "core/parallel.h"
#include "io/exr/description.h"
#include "io/files/channel_reader.h"
#include "io/files/file_identity.h"
#include "io/files/missing_file.h"
#include "io/files/plain_image_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Zeros where the file is shorter.
std::array<char, 8> first_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::array<char, 8> head{};
  stream.read(head.data(), head.size());
  return head;
}

bool begins_with_zeros(const std::string& path) {
  const auto head = first_bytes(path);
  return std::all_of(head.begin(), head.end(), [](char c) { return c == 0; });
}

std::uint64_t size_of_existing(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) throw missing_file(path);
  if (!std::filesystem::is_regular_file(path, failure)) refuse_file(path, "not a file");
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure || !std::ifstream(path, std::ios::binary)) refuse_file(path, "cannot be opened for reading");
  if (bytes == 0 || begins_with_zeros(path)) refuse_file(path, "not yet rendered: the file has no contents");
  return bytes;
}

/// A linear format that renderers write.
struct PlainFormat {
  std::string_view extension, name;
  std::array<std::string_view, 4> beginnings;  ///< First bytes of its files.
};

constexpr std::array<std::string_view, 4> tiff_beginnings{{{"II*\0", 4}, {"MM\0*", 4}, {"II+\0", 4}, {"MM\0+", 4}}};
constexpr std::array<PlainFormat, 4> plain_formats{{{".pfm", "pnm", {"PF", "Pf"}},
                                                    {".hdr", "hdr", {"#?"}},
                                                    {".tif", "tiff", tiff_beginnings},
                                                    {".tiff", "tiff", tiff_beginnings}}};

/// What to do with a file that is no render, by its extension; empty where it is not known.
std::string hint_for(const std::string& extension) {
  if (extension == ".blend") return "; polyrecon-blender renders the scene and denoises it";
  for (const char* picture : {".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tga"})
    if (extension == picture) return "; save the render as OpenEXR, which keeps its passes and its range";
  return "";
}

/// The format that the name stands for. Throws where there is none, and where the file begins as another format: a
/// format that is not needed is refused, since each decoder has faults of its own.
std::string plain_format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::find_if(plain_formats.begin(), plain_formats.end(),
                                  [&](const PlainFormat& f) { return f.extension == extension; });
  if (found == plain_formats.end()) refuse_file(path, "not an OpenEXR file" + hint_for(extension));
  const auto head = first_bytes(path);
  if (std::none_of(found->beginnings.begin(), found->beginnings.end(), [&](std::string_view beginning) {
        return !beginning.empty() && std::string_view(head.data(), beginning.size()) == beginning;
      }))
    refuse_file(path, fmt::format("does not begin as a {} file does; give it the extension of its format", extension));
  return std::string(found->name);
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
  file.stamp = stamp_of(path);
  file.bytes = size_of_existing(path);
  if (Imf::isOpenExrFile(path.c_str())) {
    describe_exr(file, limits);
  } else {
    file.format = plain_format_of(path);
    describe_plain_image(file, limits);
  }
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
