#include "io/files/decode_file.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include "core/first_line.h"
#include "io/exr/bands.h"
#include "io/files/file.h"
#include "polyrecon/error.h"

namespace polyrecon {

void decode_file(const std::string& path) {
  const FileInfo info = describe_file(path);
  if (info.format != "openexr") throw Error(ExitCode::BadInput, path + ": is no OpenEXR file");
  try {
    Imf::MultiPartInputFile file(path.c_str(), Imf::globalThreadCount(), false);
    for (int p = 0; p < file.parts(); ++p) {
      if (!info.parts[static_cast<std::size_t>(p)].readable()) continue;
      Imf::InputPart part(file, p);
      NativeBand band(part.header());
      for (const auto& [y0, y1] : bands_of(part.header())) {
        band.take_lines(y0, y1);
        read_band(part, band);
      }
    }
  } catch (const Iex::BaseExc& problem) {
    throw Error(ExitCode::BadInput, fmt::format("{}: incomplete or damaged ({})", path, first_line(problem.what())));
  }
}

}  // namespace polyrecon
