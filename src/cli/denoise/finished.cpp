#include "cli/denoise/finished.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "io/decode_file.h"
#include "io/exr/file.h"
#include "io/file_identity.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

bool says(const FileInfo& file, const std::string& attribute, const std::string& value) {
  const AttributeInfo* found = find_attribute(file.parts.front(), attribute);
  return found && found->value == value;
}

}  // namespace

std::string input_identity(const FrameFiles& files, const FrameSource& source) {
  std::string text;
  for (const FileInfo& file : source.files) text += (text.empty() ? "" : "; ") + file_identity(file.path);
  for (const NeighbourFile& neighbour : files.neighbours)
    if (exists(neighbour.path)) text += fmt::format("; {:+d}: {}", neighbour.offset, file_identity(neighbour.path));
  return text;
}

bool is_finished(const FrameFiles& files, const DenoiseOptions& options) {
  for (const std::string* path : {&files.output, &files.error_map, &files.order_map, &files.sample_map, &files.report})
    if (!path->empty() && !exists(*path)) return false;
  const FrameSource source = read_frame_header(files.input, options.read).source;
  try {
    const FileInfo output = describe_file(files.output);
    if (!says(output, "polyrecon/version", POLYRECON_VERSION) ||
        !says(output, "polyrecon/settings", settings_text(options)) ||
        !says(output, "polyrecon/input", input_identity(files, source)))
      return false;
    for (const std::string* path : {&files.output, &files.error_map, &files.order_map, &files.sample_map})
      if (!path->empty()) decode_file(*path);
  } catch (const Error&) {
    return false;  // damaged: it is made anew
  }
  return true;
}

}  // namespace polyrecon
