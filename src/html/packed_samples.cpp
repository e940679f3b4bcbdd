#include "html/packed_samples.h"

#include <Imath/half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/parallel.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// zlib's level of packing, 1 to 9. Noisy halves get hardly smaller at higher levels, which take several times as long.
constexpr int packing = 1;

constexpr int stored = 0;  // zlib's level without packing

/// Bytes of a piece that one thread packs.
constexpr std::size_t piece_bytes = std::size_t{4} << 20;

/// Bytes of the beginning of a piece, and the part of them that must remain after packing, for the piece to be stored
/// as it is: the lower bytes of noise get hardly smaller, and packing them takes a third of the time of a page.
constexpr std::size_t tried_bytes = std::size_t{64} << 10;
constexpr double not_worth_packing = 0.95;

std::uint32_t bits_of(Real value, PageSamples samples) {
  const auto narrow = static_cast<float>(value);
  if (samples == PageSamples::Half) return Imath::half(narrow).bits();
  std::uint32_t bits = 0;
  std::memcpy(&bits, &narrow, sizeof bits);
  return bits;
}

/// The bytes of all planes before zlib.
std::string split_bytes(const Image& image, PageSamples samples) {
  const std::size_t bytes = samples == PageSamples::Half ? 2 : 4, n = image.pixels();
  std::string out(bytes * n * static_cast<std::size_t>(image.channels()), '\0');
  in_parallel(static_cast<std::size_t>(image.channels()), [&](std::size_t c) {
    const Real* plane = image.plane(static_cast<int>(c));
    char* target = out.data() + c * bytes * n;
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t bits = bits_of(plane[i], samples), difference = bits - before;
      before = bits;
      for (std::size_t b = 0; b < bytes; ++b)
        target[b * n + i] = static_cast<char>(difference >> 8 * (bytes - 1 - b) & 255);
    }
  });
  return out;
}

/// A piece of a stream of zlib's format, without its head and its checksum.
struct Piece {
  std::string packed;
  uLong checksum = 0;
};

Piece pack(const char* bytes, std::size_t count, int level, bool last) {
  z_stream stream{};
  constexpr int raw = -15, memory_level = 9;  // a window of 2^15 bytes, without head and checksum
  if (deflateInit2(&stream, level, Z_DEFLATED, raw, memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ExitCode::OutOfMemory, "not enough memory to pack the pictures of a page");
  Piece piece;
  piece.packed.resize(deflateBound(&stream, static_cast<uLong>(count)) + 16);
  const auto* input = reinterpret_cast<const Bytef*>(bytes);
  stream.next_in =
      const_cast<Bytef*>(input);  // NOLINT(cppcoreguidelines-pro-type-const-cast): zlib does not write to it
  stream.avail_in = static_cast<uInt>(count);
  stream.next_out = reinterpret_cast<Bytef*>(piece.packed.data());
  stream.avail_out = static_cast<uInt>(piece.packed.size());
  const int done = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
  piece.packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (done != (last ? Z_STREAM_END : Z_OK) || stream.avail_in != 0)
    throw Error(ExitCode::Internal, "zlib could not pack a picture");
  piece.checksum = adler32(adler32(0, nullptr, 0), input, static_cast<uInt>(count));
  return piece;
}

/// The level for a piece, by its beginning.
int level_for(const char* bytes, std::size_t count) {
  const std::size_t tried = std::min(count, tried_bytes);
  const bool pays = static_cast<double>(pack(bytes, tried, packing, true).packed.size()) <
                    not_worth_packing * static_cast<double>(tried);
  return pays ? packing : stored;
}

/// Pieces are packed in parallel and joined; the bytes do not depend on the number of threads.
std::string zlib_packed(const std::string& bytes) {
  std::vector<Piece> pieces(std::max<std::size_t>((bytes.size() + piece_bytes - 1) / piece_bytes, 1));
  in_parallel(pieces.size(), [&](std::size_t i) {
    const std::size_t begin = i * piece_bytes, count = std::min(piece_bytes, bytes.size() - begin);
    const char* const piece = bytes.data() + begin;
    pieces[i] = pack(piece, count, level_for(piece, count), i + 1 == pieces.size());
  });
  std::string out("\x78\x01", 2);  // a window of 2^15 bytes, least effort
  uLong checksum = adler32(0, nullptr, 0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    out += pieces[i].packed;
    const std::size_t count = std::min(piece_bytes, bytes.size() - i * piece_bytes);
    checksum = adler32_combine(checksum, pieces[i].checksum, static_cast<z_off_t>(count));
  }
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(checksum >> shift & 255);
  return out;
}

}  // namespace

bool fit_into_halves(const Image& image) {
  constexpr Real largest = 65504;
  for (int c = 0; c < image.channels(); ++c)
    if (std::any_of(image.plane(c), image.plane(c) + image.pixels(),
                    [](Real v) { return std::isfinite(v) && std::abs(v) > largest; }))
      return false;
  return true;
}

std::string packed_samples(const Image& image, PageSamples samples) {
  return base64(zlib_packed(split_bytes(image, samples)));
}

std::string base64(const std::string& bytes) {
  constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out((bytes.size() + 2) / 3 * 4, '=');
  for (std::size_t i = 0, o = 0; i < bytes.size(); i += 3, o += 4) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k <= count; ++k) out[o + k] = letters[group >> (18 - 6 * k) & 63];
  }
  return out;
}

}  // namespace polyrecon
