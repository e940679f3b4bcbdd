#pragma once

#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>

#include <functional>
#include <string>
#include <vector>

#include "core/rect.h"

namespace polyrecon {

/// One channel of a band, in the type of the file: rows of the data window's width.
struct NativeChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  std::vector<char> samples;
};

/// Some lines of all channels of a part, bit for bit.
struct NativeBand {
  int x0 = 0, width = 0;
  int y0 = 0, y1 = 0;  ///< Lines y0 .. y1 - 1 in the file's coordinates; none at first.
  std::vector<NativeChannel> channels;

  explicit NativeBand(const Imf::Header& header);
  /// Makes room for other lines; memory is kept, since fresh pages for each band of a frame would take longer than
  /// their samples do. The samples are unspecified until they are filled.
  void take_lines(int first, int last_excluded);
  NativeChannel* find(const std::string& name);
  Imf::FrameBuffer buffer();
};

std::size_t size_of(Imf::PixelType type);

/// A hash of 64 bits of each channel's samples.
std::vector<std::size_t> hashes_of(const NativeBand& band);

/// The level, of 9, for all that is written: zlib takes a fifth less time than at the usual 4, files grow by 4 %.
constexpr int zip_level = 2;

constexpr int band_lines = 256;  ///< A multiple of the lines in a chunk, whatever the compression.

/// The bands that cover a part: so many lines each, or a row of tiles, in the order in which the part's line order has
/// them written.
std::vector<std::pair<int, int>> bands_of(const Imf::Header& header, int lines = band_lines);

/// Decodes the lines of band from a flat part whose channels have one sample a pixel.
void read_band(Imf::InputPart& input, NativeBand& band);

/// Writes a part band by band; make fills the lines of each band. The bands are those of bands_of, in its order.
void write_bands(Imf::MultiPartOutputFile& output, int part, const std::function<void(NativeBand&)>& make,
                 int lines = band_lines);

}  // namespace polyrecon
