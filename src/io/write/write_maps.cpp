#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "io/exr/encode.h"
#include "io/files/single_part.h"
#include "io/renderers/polyrecon.h"
#include "io/write/store.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

Imath::Box2i to_box(const Rect& r) { return {{r.x0, r.y0}, {r.x1 - 1, r.y1 - 1}}; }

Imf::Header map_header(const std::vector<MapChannel>& channels, const Rect& data_window, const Rect& display_window,
                       const MapAttributes& attributes, const Encoding& encoding) {
  Imf::Header header(to_box(display_window), to_box(data_window));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setType(Imf::SCANLINEIMAGE);
  for (const MapChannel& channel : channels)
    header.channels().insert(channel.name, Imf::Channel(channel.is_half ? Imf::HALF : Imf::FLOAT));
  encode(header, encoding, {});
  header.insert(version_attribute, Imf::StringAttribute(POLYRECON_VERSION));
  for (const auto& [name, text] : attributes.strings)
    if (!text.empty()) header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : attributes.numbers)
    header.insert(name, Imf::FloatAttribute(static_cast<float>(number)));
  return header;
}

void fill_map_band(const std::vector<MapChannel>& channels, const Rect& data_window, NativeBand& band) {
  std::size_t ignored = 0;
  const std::size_t begin = static_cast<std::size_t>(band.y0 - data_window.y0) * static_cast<std::size_t>(band.width);
  const std::size_t pixels = static_cast<std::size_t>(band.y1 - band.y0) * static_cast<std::size_t>(band.width);
  for (const MapChannel& from : channels) {
    NativeChannel* to = band.find(from.name);
    for (std::size_t i = 0; i < pixels; ++i) store(*to, i, static_cast<float>(from.image.plane(0)[begin + i]), ignored);
  }
}

}  // namespace

void write_maps(const std::string& target, const std::vector<MapChannel>& channels, const Rect& data_window,
                const Rect& display_window, const MapAttributes& attributes, const Encoding& encoding) {
  write_single_part(target, map_header(channels, data_window, display_window, attributes, encoding),
                    [&](NativeBand& band) { fill_map_band(channels, data_window, band); });
}

}  // namespace polyrecon
