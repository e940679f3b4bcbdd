#include "cli/denoise/finished.h"

#include <filesystem>
#include <system_error>

#include "cli/denoise/load_frame.h"
#include "io/files/decode_file.h"
#include "io/files/file.h"
#include "io/files/file_identity.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

bool has_attribute(const FileInfo& file, const std::string& attribute, const std::string& value) {
  const AttributeInfo* found = find_attribute(file.parts.front(), attribute);
  return found && found->value == value;
}

/// The identity of all files with its passes, or of the named one if they cannot be found.
std::string neighbour_identity(const Job& job, const NeighbourFile& neighbour) {
  try {
    return files_identity(read_frame_header(neighbour.path, read_options_for(job, neighbour.frame)).source.files);
  } catch (const Error&) {
    return file_identity(neighbour.path);
  }
}

/// The identity that a result would have if the frame was read now.
std::string present_identity(const Job& job, const FrameFiles& files, const FrameSource& source) {
  std::string text = files_identity(source.files);
  for (const NeighbourFile& neighbour : files.neighbours)
    if (std::error_code ignored; std::filesystem::is_regular_file(neighbour.path, ignored))
      text += neighbour_text(neighbour.offset, neighbour_identity(job, neighbour));
  return text;
}

}  // namespace

bool is_finished(const Job& job, const FrameFiles& files) {
  const OutputPaths& outputs = files.outputs;
  for (const OutputOption& option : output_options())
    if (const std::string& path = outputs.*option.path; !path.empty() && !exists(path)) return false;
  const FrameSource source = read_frame_header(files.input, read_options_for(job, files.number_in_names())).source;
  std::vector<OutputPaths> of_pictures{outputs};
  for (std::size_t p = 1; p < source.pictures.size(); ++p)
    of_pictures.push_back(maps_of(outputs, {source.pictures[p], {}}));
  try {
    const FileInfo picture = describe_file(outputs.picture);
    if (!has_attribute(picture, version_attribute, POLYRECON_VERSION) ||
        !has_attribute(picture, settings_attribute, settings_of(job, files)) ||
        !has_attribute(picture, input_attribute, present_identity(job, files, source)))
      return false;
    for (const OutputPaths& paths : of_pictures)
      for (const OutputOption& option : output_options())
        if (const std::string& path = paths.*option.path; option.kind != OutputKind::Report && !path.empty())
          decode_file(path);
  } catch (const Error&) {
    return false;  // a damaged output is written again
  }
  return true;
}

}  // namespace polyrecon
