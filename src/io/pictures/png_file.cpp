#include "io/pictures/png_file.h"

#include <OpenImageIO/strutil.h>

#include "io/files/atomic_file.h"
#include "io/pictures/preview.h"

namespace polyrecon {

void write_png(const std::string& target, const Image& rgb) { write_bytes(target, encode_png(rgb)); }

std::string png_data_uri(const Image& rgb) {
  return "data:image/png;base64," + OIIO::Strutil::base64_encode(encode_png(rgb));
}

}  // namespace polyrecon
