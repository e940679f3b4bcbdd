#include "cli/denoise/load_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/stopwatch.h"
#include "io/files/file_identity.h"

namespace polyrecon {

std::string PictureChoice::name() const {
  std::string text = name_of(place);
  if (layer.empty()) return text;
  return text + (text.empty() ? "" : ", ") + "layer " + layer;
}

OutputPaths maps_of(OutputPaths outputs, const PictureChoice& picture) {
  std::string label;
  for (const std::string& word : {picture.place.view_layer, picture.place.view, picture.layer})
    if (!word.empty()) label += "." + word;
  std::replace(label.begin(), label.end(), '/', '_');
  for (const OutputOption& option : output_options()) {
    std::string& path = outputs.*option.path;
    if (option.kind != OutputKind::Map || path.empty()) continue;
    const std::filesystem::path file(path);
    path = (file.parent_path() / (file.stem().string() + label + file.extension().string())).string();
  }
  return outputs;
}

ReadOptions with_picture(ReadOptions options, const PictureChoice& picture) {
  options.picture = picture.place;
  options.own_windows = picture.layer;
  if (!picture.layer.empty()) options.aovs.clear();
  return options;
}

std::string neighbour_text(int offset, const std::string& identity) {
  return fmt::format("; {:+d}: {}", offset, identity);
}

std::string LoadedFrame::neighbours_identity() const {
  std::string text;
  for (const LoadedNeighbour& neighbour : neighbours) text += neighbour_text(neighbour.offset, neighbour.identity);
  return text;
}

LoadedFrame load_frame(const std::string& path, const ReadOptions& options) {
  const Stopwatch watch;
  LoadedFrame loaded{read_frame(path, options), 0, {}, {}, {}};
  loaded.identity = files_identity(loaded.in.source.files);
  for (const FileInfo& file : loaded.in.source.files) require_unchanged(file);
  loaded.read_seconds = watch.seconds();
  loaded.picture = {{loaded.in.source.view_layer, loaded.in.source.view}, options.own_windows};
  return loaded;
}

}  // namespace polyrecon
