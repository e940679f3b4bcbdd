#include "io/exr/description.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>

#include <exception>
#include <new>
#include <vector>

#include "core/first_line.h"
#include "io/exr/attributes.h"
#include "io/exr/chunks.h"
#include "io/exr/compression.h"
#include "io/exr/guard.h"
#include "io/exr/out_of_memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

Rect to_rect(const Imath::Box2i& box) { return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1}; }

SampleType to_sample_type(Imf::PixelType type) {
  if (type == Imf::HALF) return SampleType::Half;
  return type == Imf::UINT ? SampleType::Uint : SampleType::Float;
}

PartInfo describe_part(const Imf::Header& header) {
  PartInfo part;
  if (header.hasName()) part.name = header.name();
  if (header.hasView()) part.view = header.view();
  part.data_window = to_rect(header.dataWindow());
  part.display_window = to_rect(header.displayWindow());
  part.compression = compression_name(header.compression());
  part.deep = header.hasType() && Imf::isDeepData(header.type());
  part.tiled = header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
  part.mipmapped = part.tiled && header.tileDescription().mode != Imf::ONE_LEVEL;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    part.channels.push_back({c.name(), to_sample_type(c.channel().type), c.channel().xSampling, c.channel().ySampling});
  if (Imf::hasMultiView(header)) part.views = Imf::multiView(header);
  for (auto a = header.begin(); a != header.end(); ++a)
    part.attributes.push_back({a.name(), a.attribute().typeName(), attribute_text(a.attribute())});
  return part;
}

}  // namespace

void describe_exr(FileInfo& file, const ReadLimits& limits) {
  const std::uint64_t table_begin = check_attribute_sizes(file.path, file.bytes);
  std::vector<Imf::Header> headers;
  try {
    Imf::MultiPartInputFile input(file.path.c_str(), 0, false);
    for (int p = 0; p < input.parts(); ++p) headers.push_back(input.header(p));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    throw_if_out_of_memory(problem);
    throw Error(ExitCode::BadInput,
                fmt::format("{}: incomplete or damaged header ({})", file.path, first_line(problem.what())));
  }
  check_claims(file.path, file.bytes, headers, limits);
  check_chunks(file.path, file.bytes, table_begin, headers);
  file.format = "openexr";
  for (const Imf::Header& header : headers) file.parts.push_back(describe_part(header));
}

}  // namespace polyrecon
