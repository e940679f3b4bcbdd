#include "cli/denoise/write_outputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/common/map_files.h"
#include "io/layers/result_layers.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

/// The layer that takes the result: a layer with windows of its own is replaced itself.
std::string result_layer(const DonePicture& done) {
  if (!done.report.picture.layer.empty()) return done.in.frame.beauty.name;
  return result_layer(done.in.source, done.in.frame.beauty.name);
}

MapWindows windows_of(const ReadResult& in, const std::string& layer_name) {
  for (const Layer& layer : in.source.layers)
    if (layer.name == layer_name && layer.file == 0)
      return {in.frame.data_window, in.source.files[0].parts[static_cast<std::size_t>(layer.part)].display_window};
  return {in.frame.data_window, in.frame.data_window};
}

/// Why alpha is not written though it was requested; empty where it is.
std::string alpha_note(const ReadResult& in, const Result& result) {
  if (result.alpha.empty()) return "--alpha has no effect: the input has no alpha; name one with --map alpha=LAYER";
  for (const Layer& layer : in.source.layers)
    if (layer.name == in.source.alpha_layer && layer.file != 0)
      return fmt::format("--alpha has no effect: {} is in another file", layer.name);
  return {};
}

void add_replacements(const DonePicture& done, bool with_alpha, std::vector<Replacement>& list) {
  const ReadResult& in = done.in;
  const Rect& window = in.frame.data_window;
  const std::string picture = result_layer(done);
  list.push_back({picture, done.result.beauty, false, window});
  for (std::size_t i = 0; i < done.result.aovs.size(); ++i)
    list.push_back({in.frame.aovs[i].name, done.result.aovs[i], false, window});
  if (with_alpha && alpha_note(in, done.result).empty())
    list.push_back({alpha_layer(in.source, in.frame.beauty.name, picture), done.result.alpha, true, window});
}

/// Adds the maps that are layers of the result.
void add_maps(const ResultContents& contents, const DonePicture& done, std::vector<Addition>& list) {
  const Rect& window = done.in.frame.data_window;
  const std::string picture = result_layer(done);
  if (contents.error) list.push_back({picture, error_suffix, done.result.error.relative_mse, window});
  if (contents.order) list.push_back({picture, order_suffix, done.result.order, window});
}

/// The source of the first picture with the layers that were added for the others.
FrameSource joined_source(const std::vector<DonePicture>& pictures) {
  FrameSource source = pictures.front().in.source;
  for (const DonePicture& done : pictures)
    for (const Layer& layer : done.in.source.layers)
      if (layer.file == 0 && std::none_of(source.layers.begin(), source.layers.end(),
                                          [&](const Layer& l) { return l.name == layer.name; }))
        source.layers.push_back(layer);
  return source;
}

/// Writes the maps of one picture. Returns notes about them.
std::vector<std::string> write_maps_of(const Job& job, const FrameFiles& files, const DonePicture& done,
                                       const OutputPaths& outputs, Progress& progress) {
  const MapWindows windows = windows_of(done.in, result_layer(done));
  const Result& result = done.result;
  if (!outputs.order_map.empty()) write_order_map(outputs.order_map, result.order, windows);
  if (outputs.error_map.empty() && !job.sample_map) return {};
  const Image& samples = done.in.frame.sample_count;
  if (!outputs.error_map.empty()) write_error_map(outputs.error_map, result.error, samples, windows);
  if (!job.sample_map) return {};
  return {"sample map: " + make_and_write_sample_map(outputs.sample_map, result.error, samples, windows,
                                                     sample_map_for(job, files), progress)};
}

/// The identity of the input of all pictures, each of which was read separately.
std::string input_identity(const std::vector<DonePicture>& pictures) {
  const DonePicture& first = pictures.front();
  const auto all = [&](const auto& has) { return std::all_of(pictures.begin(), pictures.end(), has); };
  if (!all(
          [&](const DonePicture& p) { return p.in.source.files.front().stamp == first.in.source.files.front().stamp; }))
    throw Error(ExitCode::BadInput,
                fmt::format("{}: was changed while its pictures were read; run again", first.in.source.path));
  const bool same = all([&](const DonePicture& p) { return p.neighbours_identity == first.neighbours_identity; });
  return first.identity + first.neighbours_identity + (same ? "" : "; a neighbour was changed");
}

}  // namespace

std::vector<std::string> write_outputs(const Job& job, const FrameFiles& files,
                                       const std::vector<DonePicture>& pictures, Progress& progress) {
  const DonePicture& first = pictures.front();
  WriteOptions options;
  options.keep_noisy = job.contents.noisy;
  options.keep_layers = job.contents.layers;
  options.keep_working = job.contents.working;
  options.encoding = job.encoding;
  options.provenance = {settings_of(job, files), input_identity(pictures), first.result.report.estimated_relative_mse};
  std::vector<Replacement> replacements;
  for (const DonePicture& done : pictures)
    add_replacements(done, job.params.reconstruct_alpha && done.report.picture.layer.empty(), replacements);
  for (const DonePicture& done : pictures) add_maps(job.contents, done, options.additions);
  std::vector<std::string> notes = write_result(joined_source(pictures), replacements, files.outputs.picture, options);
  if (job.params.reconstruct_alpha)
    if (const std::string note = alpha_note(first.in, first.result); !note.empty()) notes.push_back(note);
  for (const DonePicture& done : pictures) {
    const bool is_first = &done == &first;
    const OutputPaths outputs = is_first ? files.outputs : maps_of(files.outputs, done.report.picture);
    for (const std::string& note : write_maps_of(job, files, done, outputs, progress)) notes.push_back(note);
    if (is_first) continue;
    for (const OutputOption& option : output_options())
      if (const std::string& path = outputs.*option.path; option.kind == OutputKind::Map && !path.empty())
        notes.push_back(fmt::format("map of {}: {}", done.report.picture.name(), path));
  }
  return notes;
}

}  // namespace polyrecon
