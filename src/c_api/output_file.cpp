#include "c_api/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "io/files/atomic_file.h"
#include "io/files/file_identity.h"
#include "io/layers/result_layers.h"
#include "maps/error_map_images.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The name of the mean of the beauty: that of the frame, also where only the header was read.
std::string beauty_of(const FrameSource& source) {
  for (const RoleChoice& choice : source.chosen)
    if (choice.role == Role::Beauty && choice.companion == Companion::Mean) return choice.layer;
  return {};
}

const Layer* find_layer(const FrameSource& source, const std::string& name) {
  const auto found = std::find_if(source.layers.begin(), source.layers.end(),
                                  [&](const Layer& layer) { return layer.file == 0 && layer.name == name; });
  return found == source.layers.end() ? nullptr : &*found;
}

/// The layer that takes new samples. A further layer may be named within the view layer.
const Layer& target_of(const FrameSource& source, const NewLayer& layer) {
  const std::string beauty = beauty_of(source), picture = result_layer(source, beauty);
  const std::string name = layer.role == Role::Beauty  ? picture
                           : layer.role == Role::Alpha ? alpha_layer(source, beauty, picture)
                                                       : layer.name;
  if (const Layer* found = find_layer(source, name)) return *found;
  if (const Layer* found = find_layer(source, source.view_layer + "." + name)) return *found;
  throw Error(ExitCode::Usage, layer.role == Role::Alpha ? fmt::format("{}: has no alpha", source.path)
                                                         : fmt::format("{}: has no layer '{}'", source.path, name));
}

}  // namespace

std::vector<NamedImage> result_images(const Frame& frame, Result result, bool with_alpha) {
  std::vector<NamedImage> images;
  images.push_back({"result", std::move(result.beauty)});
  for (std::size_t i = 0; i < result.aovs.size(); ++i)
    images.push_back({"aov " + frame.aovs[i].name, std::move(result.aovs[i])});
  if (with_alpha && !result.alpha.empty()) images.push_back({name_of(Role::Alpha), std::move(result.alpha)});
  images.push_back({"order", std::move(result.order)});
  for (const ErrorMapImage& entry : error_map_images)
    if (Image& image = result.error.*entry.image; !image.empty())
      images.push_back({error_image_name(entry), std::move(image)});
  return images;
}

std::string error_image_name(const ErrorMapImage& entry) {
  const std::string channel = entry.names[0];
  return channel.substr(0, channel.find('.'));
}

void require_exr_output(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  if (ending != ".exr")
    throw Error(ExitCode::Usage, fmt::format("{}: an EXR file is written, so its name must end in .exr", path));
  check_writable(path);
}

std::string identity_of_input(const FrameSource& source) {
  std::string text = files_identity(source.files);
  for (const FileInfo& file : source.files) require_unchanged(file);
  return text;
}

std::vector<std::string> write_like(const ReadResult& in, const std::vector<NewLayer>& layers,
                                    const std::string& target, const WriteOptions& options) {
  std::vector<Replacement> replacements;
  for (const NewLayer& layer : layers) {
    const Layer& to = target_of(in.source, layer);
    const Rect window = in.frame.beauty.mean.empty()
                            ? in.source.files[0].parts[static_cast<std::size_t>(to.part)].data_window
                            : in.frame.data_window;
    if (layer.image.width() != window.width() || layer.image.height() != window.height())
      throw Error(ExitCode::Usage,
                  fmt::format("{}: layer '{}' has {} x {} pixels, the image has {} x {}", in.source.path, to.name,
                              window.width(), window.height(), layer.image.width(), layer.image.height()));
    replacements.push_back({to.name, layer.image, layer.role == Role::Alpha, window});
  }
  return write_result(in.source, replacements, target, options);
}

}  // namespace polyrecon
