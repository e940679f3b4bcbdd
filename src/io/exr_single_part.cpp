#include "io/exr_single_part.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "io/atomic_file.h"

namespace polyrecon {
void write_single_part(const std::string& target, const Imf::Header& header,
                       const std::function<void(NativeBand&)>& make, int lines) {
  std::vector<std::size_t> hashes;
  const auto write = [&](const std::string& path) {
    Imf::MultiPartOutputFile output(path.c_str(), &header, 1, true);
    const auto make_and_remember = [&](NativeBand& band) {
      make(band);
      for (const NativeChannel& channel : band.channels) hashes.push_back(hash_of(channel));
    };
    write_bands(output, 0, make_and_remember, lines);
  };
  const auto verify = [&](const std::string& path) {
    Imf::MultiPartInputFile written(path.c_str(), Imf::globalThreadCount(), false);
    Imf::InputPart back(written, 0);
    auto expected = hashes.begin();
    for (const auto& [y0, y1] : bands_of(header, lines)) {
      NativeBand band(back.header(), y0, y1);
      read_band(back, band);
      for (const NativeChannel& channel : band.channels)
        if (expected == hashes.end() || hash_of(channel) != *expected++)
          throw std::runtime_error(fmt::format("channel {} differs when it is read back", channel.name));
    }
  };
  write_atomically(target, write, verify);
}

}  // namespace polyrecon
