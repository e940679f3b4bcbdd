#include "io/files/single_part.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "io/files/atomic_file.h"

namespace polyrecon {
void write_single_part(const std::string& target, const Imf::Header& header,
                       const std::function<void(NativeBand&)>& make, int lines) {
  std::vector<std::size_t> hashes;
  const auto write = [&](const std::string& path) {
    Imf::MultiPartOutputFile output(path.c_str(), &header, 1, true);
    const auto make_and_remember = [&](NativeBand& band) {
      make(band);
      const std::vector<std::size_t> of_band = hashes_of(band);
      hashes.insert(hashes.end(), of_band.begin(), of_band.end());
    };
    write_bands(output, 0, make_and_remember, lines);
  };
  const auto verify = [&](const std::string& path) {
    Imf::MultiPartInputFile written(path.c_str(), Imf::globalThreadCount(), false);
    Imf::InputPart back(written, 0);
    NativeBand band(back.header());
    auto expected = hashes.begin();
    for (const auto& [y0, y1] : bands_of(header, lines)) {
      band.take_lines(y0, y1);
      read_band(back, band);
      const std::vector<std::size_t> found = hashes_of(band);
      for (std::size_t c = 0; c < found.size(); ++c)
        if (expected == hashes.end() || found[c] != *expected++)
          throw std::runtime_error(fmt::format("channel {} differs when it is read back", band.channels[c].name));
    }
  };
  write_atomically(target, write, verify);
}

}  // namespace polyrecon
