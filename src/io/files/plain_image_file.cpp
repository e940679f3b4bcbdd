#include "io/files/plain_image_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "core/bad_file.h"
#include "core/first_line.h"

namespace polyrecon {
namespace {

/// Opens a file with the decoder of its format; OpenImageIO would choose one by the file's contents.
std::unique_ptr<OIIO::ImageInput> open_image(const FileInfo& file) {
  auto input = OIIO::ImageInput::create(file.format);
  if (!input) refuse_file(file.path, fmt::format("cannot be read ({})", first_line(OIIO::geterror())));
  input->threads(1);  // the TIFF reader of some versions has a race
  // The rows of a PFM are stored from the bottom up. Some versions of OpenImageIO reverse them only on request.
  OIIO::ImageSpec hints, spec;
  hints.attribute("pnm:pfmflip", 1);
  hints.attribute("oiio:RawColor", 1);  // CMYK and palettes are refused below rather than converted
  if (!input->open(file.path, spec, hints))
    refuse_file(file.path, fmt::format("cannot be read ({})", first_line(input->geterror())));
  return input;
}

/// Refuses the kinds of TIFF that no renderer writes. The decoder unpacks odd sizes and separations, not always safely.
void require_plain_tiff(const FileInfo& file, const OIIO::ImageSpec& spec) {
  constexpr int black_is_zero = 1, rgb = 2;
  const int photometric = spec.get_int_attribute("tiff:PhotometricInterpretation", rgb);
  if (photometric != black_is_zero && photometric != rgb)
    refuse_file(file.path, fmt::format("a TIFF of photometric interpretation {}; save it as RGB", photometric));
  const int bits = spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
  if (bits % 8 != 0 || bits != static_cast<int>(8 * spec.format.size()))
    refuse_file(file.path, fmt::format("a TIFF of {} bits per sample; save 32-bit floats", bits));
  // The decoders of other compressions return memory that was never written where their data are damaged.
  const std::string compression = spec.get_string_attribute("compression", "none");
  for (const char* known : {"none", "zip", "lzw", "packbits"})
    if (compression == known) return;
  refuse_file(file.path, fmt::format("a TIFF with {} compression; save it with zip or none", compression));
}

SampleType to_sample_type(const OIIO::TypeDesc& type) {
  if (type.basetype == OIIO::TypeDesc::HALF) return SampleType::Half;
  return type.is_floating_point() ? SampleType::Float : SampleType::Uint;
}

}  // namespace

void describe_plain_image(FileInfo& file, const ReadLimits& limits) {
  const auto input = open_image(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.image_pixels() > limits.max_pixels ||
      static_cast<std::size_t>(spec.nchannels) > limits.max_channels)
    refuse_file(file.path, fmt::format("{} x {} pixels of {} channels are beyond the limits", spec.width, spec.height,
                                       spec.nchannels));
  if (file.format == "tiff") require_plain_tiff(file, spec);
  const std::uint64_t raw = spec.image_bytes(true);
  const bool packed = file.format != "pnm";
  if (packed ? raw / 1024 > file.bytes : raw > file.bytes)
    refuse_file(file.path, fmt::format("incomplete: {} bytes of pixels in a file of {} bytes", raw, file.bytes));
  PartInfo part;
  part.data_window = {spec.x, spec.y, spec.x + spec.width, spec.y + spec.height};
  part.display_window = {spec.full_x, spec.full_y, spec.full_x + spec.full_width, spec.full_y + spec.full_height};
  part.compression = spec.get_string_attribute("compression", "none");
  for (const std::string& name : spec.channelnames) part.channels.push_back({name, to_sample_type(spec.format)});
  for (const auto& attribute : spec.extra_attribs)
    part.attributes.push_back({attribute.name().string(), attribute.type().c_str(), attribute.get_string()});
  file.parts.push_back(std::move(part));
}

Image read_plain_image(const FileInfo& file, const std::vector<std::string>& channels) {
  const PartInfo& part = file.parts.front();
  const std::size_t stride = part.channels.size();
  std::vector<float> pixels(part.data_window.area() * stride);
  const auto input = open_image(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.nchannels != static_cast<int>(stride) || spec.width != part.data_window.width() ||
      spec.height != part.data_window.height())
    refuse_file(file.path, "was changed while it was read; run again");
  if (file.format == "tiff") require_plain_tiff(file, spec);
  // The TIFF reader of some versions answers true after an error.
  if (!input->read_image(0, 0, 0, static_cast<int>(stride), OIIO::TypeDesc::FLOAT, pixels.data()) || input->has_error())
    refuse_file(file.path, fmt::format("incomplete or damaged ({})", first_line(input->geterror())));
  Image image(part.data_window.width(), part.data_window.height(), static_cast<int>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto found = std::find_if(part.channels.begin(), part.channels.end(),
                                    [&](const ChannelInfo& channel) { return channel.name == channels[c]; });
    const auto source = static_cast<std::size_t>(found - part.channels.begin());
    for (std::size_t i = 0; i < image.pixels(); ++i)
      image.plane(static_cast<int>(c))[i] = static_cast<Real>(pixels[i * stride + source]);
  }
  return image;
}

}  // namespace polyrecon
