#include "cli/denoise/write_outputs.h"

#include <fmt/format.h>

#include "cli/common/map_files.h"
#include "cli/denoise/finished.h"
#include "io/channel_names.h"
#include "io/renderers/renderers.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

/// Whether a layer of the input file holds the picture: a prior that was named on the command line, or that stands in
/// another file, is no part of it.
bool is_picture(const Layer& layer, Role role) {
  return layer.file == 0 && (role == Role::Beauty || (layer.rank != rank_by_hand && layer.rank != rank_of_made_prior));
}

/// The layer that takes the result: the denoised one where the renderer's own denoiser wrote both, since people and
/// compositors look for the result there; else the noisy one.
std::string picture_layer(const ReadResult& in) {
  for (const Role role : {Role::Prior, Role::Beauty})
    for (const RoleChoice& choice : in.source.chosen) {
      if (choice.role != role || choice.companion != Companion::Mean) continue;
      for (const Layer& layer : in.source.layers)
        if (layer.name == choice.layer && is_picture(layer, role)) return layer.name;
    }
  return in.frame.beauty.name;
}

MapWindows windows_of(const ReadResult& in, const std::string& layer_name) {
  for (const Layer& layer : in.source.layers)
    if (layer.name == layer_name && layer.file == 0)
      return {in.frame.data_window, in.source.files[0].parts[static_cast<std::size_t>(layer.part)].display_window};
  return {in.frame.data_window, in.frame.data_window};
}

/// The layer that takes the alpha: the picture's, where the beauty's came with it, so that picture and alpha stay
/// together; else the one that it was read from.
std::string alpha_layer(const ReadResult& in, const std::string& picture) {
  if (in.source.alpha_layer != in.frame.beauty.name) return in.source.alpha_layer;
  for (const Layer& layer : in.source.layers)
    if (layer.name == picture && layer.file == 0 && !layer.alpha.empty()) return picture;
  return in.source.alpha_layer;
}

/// Why alpha is not written though it was requested; empty where it is.
std::string alpha_note(const ReadResult& in, const Result& result) {
  if (result.alpha.empty()) return "--alpha has no effect: the input has no alpha; name one with --map alpha=LAYER";
  for (const Layer& layer : in.source.layers)
    if (layer.name == in.source.alpha_layer && layer.file != 0)
      return fmt::format("--alpha has no effect: {} is in another file", layer.name);
  return {};
}

std::vector<Replacement> replacements(const ReadResult& in, const Result& result, const std::string& picture,
                                      bool with_alpha) {
  const Rect& window = in.frame.data_window;
  std::vector<Replacement> list{{picture, result.beauty, false, window}};
  for (std::size_t i = 0; i < result.aovs.size(); ++i)
    list.push_back({in.frame.aovs[i].name, result.aovs[i], false, window});
  if (with_alpha && alpha_note(in, result).empty())
    list.push_back({alpha_layer(in, picture), result.alpha, true, window});
  return list;
}

/// Samples per pixel: from the file's layer, else the number from the command line or the metadata; empty where
/// unknown.
Image sample_counts(const ReadOptions& options, const ReadResult& in) {
  if (!in.frame.sample_count.empty()) return in.frame.sample_count;
  const double everywhere = options.samples > 0
                                ? options.samples
                                : samples_in_metadata(in.source.files.front(), in.source.view_layer).value_or(0);
  return everywhere > 0 ? Image(in.frame.width(), in.frame.height(), 1, static_cast<Real>(everywhere)) : Image();
}

SampleMapOptions with_frame_number(SampleMapOptions options, const FrameFiles& files) {
  if (files.frame) options.frame = *files.frame;
  return options;
}

}  // namespace

std::vector<std::string> write_outputs(const Job& job, const FrameFiles& files, const ReadResult& in,
                                       const Result& result, Progress& progress) {
  const std::string picture = picture_layer(in);
  WriteOptions options;
  options.keep_noisy = job.keep_noisy;
  options.provenance = {settings_of(job, files), input_identity(files, in.source),
                        result.report.estimated_relative_mse};
  std::vector<std::string> notes = write_result(
      in.source, replacements(in, result, picture, job.params.reconstruct_alpha), files.outputs.picture, options);
  if (job.params.reconstruct_alpha)
    if (const std::string note = alpha_note(in, result); !note.empty()) notes.push_back(note);
  const MapWindows windows = windows_of(in, picture);
  const Image samples = sample_counts(job.read, in);
  const OutputPaths& outputs = files.outputs;
  if (!outputs.error_map.empty()) write_error_map(outputs.error_map, result.error, samples, windows);
  if (!outputs.order_map.empty()) write_order_map(outputs.order_map, result.order, windows);
  if (job.sample_map)
    notes.push_back("sample map: " + make_and_write_sample_map(outputs.sample_map, result.error, samples, windows,
                                                               with_frame_number(*job.sample_map, files), progress));
  return notes;
}

}  // namespace polyrecon
