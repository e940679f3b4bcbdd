#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/checks.h"
#include "cli/commands.h"
#include "cli/layers.h"
#include "core/error.h"
#include "estimate/score.h"

namespace polyrecon {
namespace {

struct CompareOptions {
  std::vector<std::string> files;  ///< The last one is the reference.
  bool json = false;
};

struct Row {
  std::string image, layer;
  Score score;
};

bool is_color(const Layer& layer) {
  return layer.channels.size() == 3 && layer.companion == Companion::Mean &&
         (layer.role == Role::Beauty || layer.role == Role::Prior || layer.role == Role::Color);
}

/// The variance of the reference's own mean; empty where the file has none.
Image variance_of(const LayeredFile& reference, const Layer& layer) {
  const Layer* variance = find_layer(reference, layer.name + " Variance");
  return variance && variance->channels.size() == layer.channels.size() ? read_layer(reference, *variance) : Image();
}

Row compare_layers(const LayeredFile& image, const Layer& layer, const LayeredFile& reference,
                   const Layer& reference_layer) {
  const Image x = read_layer(image, layer), r = read_layer(reference, reference_layer);
  if (!x.same_shape(r))
    throw Error(ExitCode::BadInput,
                fmt::format("{}: layer '{}' is {} x {} pixels, the reference has {} x {}", image.info.path, layer.name,
                            x.width(), x.height(), r.width(), r.height()));
  return {image.info.path, layer.name, score(x, r, variance_of(reference, reference_layer))};
}

/// The main colour layers, whatever their names, then the further colour layers that both files have under one name.
std::vector<Row> compare_file(const LayeredFile& image, const LayeredFile& reference) {
  const Layer* main = color_layer(image);
  const Layer* main_reference = color_layer(reference);
  for (const auto& [layer, path] : {std::pair{main, &image.info.path}, std::pair{main_reference, &reference.info.path}})
    if (!layer)
      throw Error(ExitCode::Missing,
                  *path + ": no R, G, B layer named Combined, Color, Beauty, RGB, Denoised or nothing");
  std::vector<Row> rows{compare_layers(image, *main, reference, *main_reference)};
  for (const Layer& layer : image.layers)
    if (const Layer* same = find_layer(reference, layer.name);
        &layer != main && same && is_color(layer) && is_color(*same))
      rows.push_back(compare_layers(image, layer, reference, *same));
  return rows;
}

nlohmann::ordered_json to_json(const std::string& reference, const std::vector<Row>& rows) {
  const auto number = [](double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(); };
  auto images = nlohmann::ordered_json::array();
  for (const Row& row : rows)
    images.push_back({{"image", row.image},
                      {"layer", row.layer},
                      {"relMSE", number(row.score.relative_mse)},
                      {"trimmed", number(row.score.trimmed)},
                      {"energy", number(row.score.energy)},
                      {"bad", row.score.bad}});
  return {{"reference", reference}, {"results", images}};
}

void run(const CompareOptions& o) {
  if (o.files.size() < 2) throw Error(ExitCode::Usage, "compare needs an image and a reference");
  for (const std::string& file : o.files) require_readable(file);
  const LayeredFile reference = open_layers(o.files.back());
  std::vector<Row> rows;
  for (std::size_t i = 0; i + 1 < o.files.size(); ++i)
    for (Row& row : compare_file(open_layers(o.files[i]), reference)) rows.push_back(std::move(row));
  if (o.json) {
    std::fputs((to_json(o.files.back(), rows).dump(2) + "\n").c_str(), stdout);
    return;
  }
  for (const Row& row : rows)
    std::fputs(fmt::format("{}: {}  relMSE {:.5f}  trimmed {:.5f}  energy {:+.5f}  bad {}\n", row.image,
                           row.layer.empty() ? "RGB" : row.layer, row.score.relative_mse, row.score.trimmed,
                           row.score.energy, row.score.bad)
                   .c_str(),
               stdout);
}

}  // namespace

void setup_compare(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* sub = app.add_subcommand("compare", "Measures images against a converged reference");
  sub->add_option("files", o->files, "One or more images, then the reference")
      ->required()
      ->type_name("IMAGE... REFERENCE");
  sub->add_flag("--json", o->json, "Print JSON");
  sub->footer(
      "relMSE is the mean over pixels and RGB of ((x - r)^2 - Var(r)) / (r^2 + 0.01), Var(r) from the reference's "
      "layer\n"
      "'<layer> Variance'; trimmed leaves out the 0.1 % worst pixels; energy is mean(x) / mean(r) - 1; bad counts "
      "pixels\n"
      "that are not finite.\n"
      "Examples:\n"
      "  polyrecon compare clean.exr reference.exr\n"
      "  polyrecon compare noisy.exr clean.exr other.exr reference.exr --json");
  sub->callback([o, &chosen] { chosen = [o] { run(*o); }; });
}

}  // namespace polyrecon
