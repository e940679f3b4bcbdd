#include "io/files/single_part.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <stdexcept>

#include "io/exr/encode.h"
#include "io/files/atomic_file.h"

namespace polyrecon {
void write_single_part(const std::string& target, const Imf::Header& header,
                       const std::function<void(NativeBand&)>& make, int lines) {
  BandCheck check(header);
  const auto write = [&](const std::string& path) {
    check = BandCheck(header);
    Imf::MultiPartOutputFile output(path.c_str(), &header, 1, true);
    const auto make_and_remember = [&](NativeBand& band) {
      make(band);
      check.keep_in_range(band);
      check.remember(band);
    };
    write_bands(output, 0, make_and_remember, lines);
  };
  const auto verify = [&](const std::string& path) {
    Imf::MultiPartInputFile written(path.c_str(), Imf::globalThreadCount(), false);
    Imf::InputPart back(written, 0);
    NativeBand band(back.header());
    for (const auto& [y0, y1] : bands_of(header, lines)) {
      band.take_lines(y0, y1);
      read_band(back, band);
      if (const NativeChannel* channel = check.first_mismatch(band))
        throw std::runtime_error(fmt::format("channel {} differs when it is read back", channel->name));
    }
  };
  write_atomically(target, write, verify);
}

}  // namespace polyrecon
