#include "io/pictures/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/comparison.h"
#include "cli/common/display_options.h"
#include "cli/common/layers.h"
#include "cli/common/memory_limit.h"
#include "cli/common/numbers.h"
#include "cli/common/progress_output.h"
#include "core/nearest.h"
#include "io/layers/layer_words.h"
#include "io/pictures/color.h"
#include "io/pictures/false_color.h"
#include "io/pictures/picture_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct PreviewOptions {
  std::vector<std::string> inputs;
  std::string output, layer, reference;
  std::vector<int> region;  ///< Left, top, width, height; empty for the whole picture.
  int zoom = 1;
  DisplayParams display;
  bool false_color = false, overwrite = false;
  std::size_t max_memory = default_memory();
};

/// The layer of a whole name, or of a name within the view layer; nullptr without one.
const Layer* layer_named(const LayeredFile& file, const std::string& name) {
  if (const Layer* layer = find_layer(file, name)) return layer;
  const auto found =
      std::find_if(file.layers.begin(), file.layers.end(), [&](const Layer& layer) { return layer.pass == name; });
  return found == file.layers.end() ? nullptr : &*found;
}

/// The layers that a text names as --aov of denoise takes it: names, patterns, "all" for the light AOVs.
std::vector<const Layer*> wanted_layers(const LayeredFile& file, const std::string& text) {
  if (text.empty()) return {&main_layer(file)};
  std::vector<const Layer*> wanted;
  for (const std::string& word : layer_words(text, file.layers)) {
    const std::size_t before = wanted.size();
    if (const Layer* layer = layer_named(file, word))
      wanted.push_back(layer);
    else
      for (const Layer& other : file.layers)
        if (word == "all" ? is_light_aov(other) : is_layer_pattern(word) && fits_pattern(other, word))
          wanted.push_back(&other);
    if (wanted.size() > before) continue;
    std::vector<std::string> names;
    for (const Layer& layer : file.layers) names.insert(names.end(), {layer.name, layer.pass});
    throw Error(ExitCode::Missing, fmt::format("{}: has no layer '{}'{} (polyrecon inspect lists the layers)",
                                               file.info.path, word, did_you_mean(word, names)));
  }
  return wanted;
}

Image mean_of_channels(const Image& image) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      out.plane(0)[i] += image.plane(c)[i] / static_cast<Real>(image.channels());
  return out;
}

/// The part of a picture that --region names.
Rect region_of(const Image& image, const PreviewOptions& o, const std::string& path) {
  if (o.region.empty()) return image.bounds();
  const int left = o.region[0], top = o.region[1], width = o.region[2], height = o.region[3];
  const bool within = left >= 0 && top >= 0 && width > 0 && height > 0 && left < image.width() &&
                      top < image.height() && width <= image.width() - left && height <= image.height() - top;
  if (!within)
    throw Error(ExitCode::Usage, fmt::format("--region {} is not within the {} x {} pixels of {}",
                                             fmt::join(o.region, ","), image.width(), image.height(), path));
  return {left, top, left + width, top + height};
}

/// A part of a picture, each of its pixels as a square of zoom x zoom.
Image enlarged(const Image& image, const Rect& part, int zoom) {
  if (part.area() * static_cast<std::size_t>(zoom * zoom) > most_pixels_of_preview)
    throw Error(ExitCode::OutOfMemory, fmt::format("the preview would be {} x {} pixels: give --region or less --zoom",
                                                   part.width() * zoom, part.height() * zoom));
  Image out(part.width() * zoom, part.height() * zoom, image.channels());
  for (int c = 0; c < out.channels(); ++c)
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) out.at(x, y, c) = image.at(part.x0 + x / zoom, part.y0 + y / zoom, c);
  return out;
}

/// The errors of the whole picture; empty for the reference itself.
std::string figures_of(const LayeredFile& file, const LayeredFile& reference) {
  if (file.info.path == reference.info.path) return {};
  const Comparison found = compare_files(file, reference, false, *make_progress(ProgressStyle::None)).front();
  return fmt::format("relMSE {:.3g}, FLIP {:.3g}", found.score.relative_mse, found.flip);
}

/// Radiance, in colour or grey, and other layers of three channels are shown as pictures. All other layers, and with
/// --false-colour all layers, are shown in false colours.
Panel make_panel(const LayeredFile& file, const Layer& layer, bool several_layers, const PreviewOptions& o) {
  const Image image = is_color(layer) ? read_radiance(file, layer) : read_layer(file, layer);
  Panel panel;
  if (image.channels() == 3 && !o.false_color) {
    panel.rgb = to_display(image, o.display);
  } else {
    const Image values = mean_of_channels(image);
    panel.range = log_range(values);
    panel.rgb = false_color(values, panel.range);
  }
  panel.rgb = enlarged(panel.rgb, region_of(panel.rgb, o, file.info.path), o.zoom);
  const std::string name = std::filesystem::path(file.info.path).filename().string();
  if (o.inputs.size() > 1 || several_layers || panel.range.high > 0)
    panel.caption = image.channels() == 3 && !several_layers ? name : fmt::format("{}: {}", name, layer.name);
  return panel;
}

void check(const PreviewOptions& o) { require_endings({{"-o", o.output, FileKind::Picture}}); }

void run(const PreviewOptions& o) {
  limit_memory(o.max_memory);
  std::vector<std::string> read = o.inputs;
  if (!o.reference.empty()) read.push_back(o.reference);
  for (const std::string& file : read) require_readable(file);
  require_outputs(read, {{"-o", o.output, FileKind::Picture}}, o.overwrite);
  std::optional<LayeredFile> reference;
  if (!o.reference.empty()) reference = open_layers(o.reference);
  std::vector<Panel> panels;
  panels.reserve(o.inputs.size());
  for (const std::string& input : o.inputs) {
    const LayeredFile file = open_layers(input);
    const std::vector<const Layer*> wanted = wanted_layers(file, o.layer);
    for (const Layer* layer : wanted) panels.push_back(make_panel(file, *layer, wanted.size() > 1, o));
    if (reference && color_layer(file)) panels.back().figures = figures_of(file, *reference);
  }
  write_picture(o.output, compose(panels));
  if (!has_font())
    std::fputs("polyrecon: found no font, so the picture has no captions; install DejaVu Sans (fonts-dejavu-core)\n",
               stderr);
}

}  // namespace

void setup_preview(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<PreviewOptions>();
  CLI::App* sub =
      app.add_subcommand("preview", "Makes a picture to look at of layers or maps, of several files side by side");
  sub->add_option("inputs", o->inputs, "Images or maps")->required()->type_name("FILE...");
  sub->add_option("-o,--output", o->output, "Picture to write: .png, .jpg or .tif")->required()->type_name("FILE");
  sub->add_option("--layer", o->layer, "Layers to show in place of the beauty, as --aov of denoise takes them")
      ->type_name("LAYER");
  sub->add_option("--region", o->region, "Part to show (default the whole picture)")
      ->delimiter(',')
      ->expected(4)
      ->type_name("X,Y,WIDTH,HEIGHT");
  sub->add_option("--zoom", o->zoom, "Pixels for each pixel, along both sides (default 1)")
      ->check(from_to(1, 32))
      ->type_name("N");
  sub->add_option("--reference", o->reference,
                  "Converged render: prints the errors of the pictures below them, as compare measures them")
      ->type_name("FILE");
  add_overwrite(*sub, o->overwrite);
  add_display_options(*sub, o->display);
  add_memory_limit(*sub, o->max_memory);
  sub->add_flag("--false-colour,--false-color", o->false_color,
                "Show logarithmic false colours with a legend, as maps always do");
  sub->footer(
      "OpenColorIO converts the colours, by the configuration in $OCIO or a built-in one for sRGB.\n"
      "Examples:\n"
      "  polyrecon preview clean.exr -o clean.png --view Filmic --exposure 1\n"
      "  polyrecon preview noisy.exr clean.exr reference.exr error.exr -o compared.png\n"
      "  polyrecon preview error.exr -o error.png --layer mse --false-colour\n"
      "  polyrecon preview noisy.exr clean.exr -o crop.png --region 200,120,160,90 --zoom 3 --reference reference.exr");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
