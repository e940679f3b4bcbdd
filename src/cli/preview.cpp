#include "io/pictures/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/display_options.h"
#include "cli/common/layers.h"
#include "cli/common/memory_limit.h"
#include "io/pictures/color.h"
#include "io/pictures/false_color.h"
#include "io/pictures/png_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct PreviewOptions {
  std::vector<std::string> inputs;
  std::string output, layer;
  DisplayParams display;
  bool false_color = false;
  std::size_t max_memory = default_memory;
};

/// The layer to show unless one was named: the picture, else the main layer of a map, else the first layer.
const Layer& main_layer(const LayeredFile& file) {
  if (const Layer* color = color_layer(file)) return *color;
  for (const char* name : {"relmse", "samples", "order"})
    if (const Layer* map = find_layer(file, name)) return *map;
  if (file.layers.empty()) throw Error(ExitCode::Missing, file.info.path + ": has no layer to show");
  return file.layers.front();
}

const Layer& wanted_layer(const LayeredFile& file, const std::string& name) {
  if (name.empty()) return main_layer(file);
  if (const Layer* layer = find_layer(file, name)) return *layer;
  throw Error(ExitCode::Missing,
              fmt::format("{}: has no layer '{}' (polyrecon inspect lists the layers)", file.info.path, name));
}

Image mean_of_channels(const Image& image) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      out.plane(0)[i] += image.plane(c)[i] / static_cast<Real>(image.channels());
  return out;
}

/// Radiance and layers of three channels are shown as pictures, all others in false colours, as on request are all.
Panel make_panel(const std::string& path, const PreviewOptions& o) {
  const LayeredFile file = open_layers(path);
  const Layer& layer = wanted_layer(file, o.layer);
  const Image image = is_color(layer) ? read_radiance(file, layer) : read_layer(file, layer);
  Panel panel;
  if (image.channels() == 3 && !o.false_color) {
    panel.rgb = to_display(image, o.display);
  } else {
    const Image values = mean_of_channels(image);
    panel.range = log_range(values);
    panel.rgb = false_color(values, panel.range);
  }
  const std::string name = std::filesystem::path(path).filename().string();
  if (o.inputs.size() > 1 || panel.range.high > 0)
    panel.caption = image.channels() == 3 ? name : fmt::format("{}: {}", name, layer.name);
  return panel;
}

void run(const PreviewOptions& o) {
  limit_memory(o.max_memory);
  for (const std::string& input : o.inputs) require_readable(input);
  require_outputs(o.inputs, {{"-o", o.output}});
  std::vector<Panel> panels;
  panels.reserve(o.inputs.size());
  for (const std::string& input : o.inputs) panels.push_back(make_panel(input, o));
  write_png(o.output, compose(panels));
  if (!has_font())
    std::fputs("polyrecon: found no font, so the picture has no captions; install DejaVu Sans (fonts-dejavu-core)\n",
               stderr);
}

}  // namespace

void setup_preview(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<PreviewOptions>();
  CLI::App* sub = app.add_subcommand("preview", "Makes a PNG of layers or maps, of several files side by side");
  sub->add_option("inputs", o->inputs, "Images or maps")->required()->type_name("FILE...");
  sub->add_option("-o,--output", o->output, "PNG to write")->required()->type_name("FILE");
  sub->add_option("--layer", o->layer, "Layer to show in place of the beauty")->type_name("NAME");
  add_display_options(*sub, o->display);
  add_memory_limit(*sub, o->max_memory);
  sub->add_flag("--false-colour,--false-color", o->false_color,
                "Show logarithmic false colours with a legend, as maps always do");
  sub->footer(
      "OpenColorIO converts the colours, by the configuration in $OCIO or a built-in one for sRGB.\n"
      "Examples:\n"
      "  polyrecon preview clean.exr -o clean.png --view Filmic --exposure 1\n"
      "  polyrecon preview noisy.exr clean.exr reference.exr error.exr -o compared.png\n"
      "  polyrecon preview error.exr -o error.png --layer mse --false-colour");
  sub->callback([o, &chosen] { chosen = [o] { run(*o); }; });
}

}  // namespace polyrecon
