#include "io/pictures/png_file.h"

#include "io/files/atomic_file.h"
#include "io/pictures/preview.h"

namespace polyrecon {

void write_png(const std::string& target, const Image& rgb) { write_bytes(target, encode_png(rgb)); }

}  // namespace polyrecon
