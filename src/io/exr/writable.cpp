#include "io/exr/writable.h"

#include <Iex.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <fmt/format.h>

#include <cstdint>

#include "core/first_line.h"
#include "io/exr/out_of_memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Forgets what is written.
class Nowhere final : public Imf::OStream {
 public:
  Nowhere() : Imf::OStream("nowhere") {}
  void write(const char* /*bytes*/, int count) override { position_ += static_cast<std::uint64_t>(count); }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

 private:
  std::uint64_t position_ = 0;
};

}  // namespace

void require_writable(const std::string& path, const std::vector<Imf::Header>& headers) {
  try {
    Nowhere nowhere;
    const Imf::MultiPartOutputFile file(nowhere, headers.data(), static_cast<int>(headers.size()), true, 0);
  } catch (const Iex::BaseExc& problem) {
    throw_if_out_of_memory(problem);
    throw Error(ExitCode::BadInput, fmt::format("{}: damaged header, which cannot be written again ({})", path,
                                                first_line(problem.what())));
  }
}

}  // namespace polyrecon
