#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/comparison.h"
#include "cli/common/display_options.h"
#include "cli/common/layers.h"
#include "cli/common/map_files.h"
#include "cli/common/memory_limit.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/common/sequence_arguments.h"
#include "cli/compare/comparison_output.h"
#include "cli/compare/comparison_page.h"
#include "core/relmse.h"
#include "io/files/atomic_file.h"
#include "io/pictures/picture_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct CompareOptions {
  std::vector<std::string> files;  ///< The last one is the reference.
  std::vector<std::string> error_maps;
  std::string html, picture, frames;
  DisplayParams display;
  bool json = false, overwrite = false;
  std::size_t max_size = default_page_size;
  std::size_t max_memory = default_memory();
};

/// A file, or the files of a sequence.
std::string path_in(const SequenceArgument& argument, const std::vector<int>& frames, std::size_t frame) {
  return argument.pattern ? argument.pattern->path(frames[frame]) : argument.text;
}

/// The relative squared error that an error map estimates; throws where it has another size.
Image read_estimate(const std::string& path, const Comparison& comparison) {
  ErrorMapFile file = read_error_map(path);
  Image& estimate = file.map.relative_mse;
  if (estimate.width() != comparison.picture.width() || estimate.height() != comparison.picture.height())
    throw Error(ExitCode::BadInput,
                fmt::format("{}: has {} x {} pixels, {} has {} x {}", path, estimate.width(), estimate.height(),
                            comparison.image, comparison.picture.width(), comparison.picture.height()));
  return std::move(estimate);
}

std::vector<NamedPath> outputs_of(const CompareOptions& o) {
  return {{"--html", o.html, FileKind::Page}, {"--picture", o.picture, FileKind::Picture}};
}

void check(const CompareOptions& o) {
  if (o.files.size() < 2) throw Error(ExitCode::Usage, "compare needs at least two files: an image and the reference");
  if (!o.error_maps.empty() && o.html.empty()) throw Error(ExitCode::Usage, "--error-map needs --html");
  require_endings(outputs_of(o));
}

void check_files(const CompareOptions& o, const std::vector<SequenceArgument>& files,
                 const std::vector<SequenceArgument>& error_maps, const std::vector<int>& frames) {
  if (!frames.empty() && !o.picture.empty())
    throw Error(ExitCode::Usage, "--picture draws one frame, not a sequence; --html writes a page with all frames");
  if (error_maps.size() + 1 > files.size())
    throw Error(ExitCode::Usage, "--error-map: there are more error maps than images");
  std::vector<std::string> inputs;
  for (const std::vector<SequenceArgument>& arguments : {files, error_maps})
    for (const SequenceArgument& argument : arguments)
      for (std::size_t k = 0; k < std::max<std::size_t>(frames.size(), 1); ++k) {
        inputs.push_back(path_in(argument, frames, k));
        require_readable(inputs.back());
        if (!argument.pattern) break;
      }
  require_outputs(inputs, outputs_of(o), o.overwrite);
}

void run(const CompareOptions& o) {
  limit_memory(o.max_memory);
  check(o);
  const std::vector<SequenceArgument> files = sequence_arguments(o.files),
                                      error_maps = sequence_arguments(o.error_maps);
  const std::vector<int> frames = common_frames(files, o.frames);
  check_files(o, files, error_maps, frames);
  const bool is_sequence = !frames.empty(), with_images = is_sequence || !o.html.empty() || !o.picture.empty();
  std::optional<ComparisonPage> page;
  if (!o.html.empty()) page.emplace(o.files, frames, !files.back().pattern, o.display, o.max_size);
  const auto progress = make_progress(ProgressStyle::None);
  const std::size_t images = files.size() - 1;
  std::vector<std::vector<Comparison>> found(images), before(images);
  for (std::size_t k = 0; k < std::max<std::size_t>(frames.size(), 1); ++k) {
    const LayeredFile reference = open_layers(path_in(files.back(), frames, k));
    for (std::size_t i = 0; i < images; ++i) {
      std::vector<Comparison> now =
          compare_files(open_layers(path_in(files[i], frames, k)), reference, with_images, *progress);
      for (Comparison& c : now) {
        if (is_sequence) c.frame = frames[k];
        if (k > 0) c.flicker = flicker_since(before[i], c);
      }
      if (page) {
        const Image estimate =
            i < error_maps.size() ? read_estimate(path_in(error_maps[i], frames, k), now.front()) : Image();
        page->add(i, k, now, estimate);
      }
      for (const Comparison& c : now) found[i].push_back(o.picture.empty() ? without_images(c) : c);
      before[i] = std::move(now);
    }
  }
  std::vector<Comparison> all;
  for (const std::vector<Comparison>& of_image : found) all.insert(all.end(), of_image.begin(), of_image.end());
  if (page) write_bytes(o.html, page->html(found));
  if (!o.picture.empty()) write_picture(o.picture, comparison_picture(all, o.display));
  if (o.json) {
    std::fputs(json_text(comparison_json(o.files.back(), all)).c_str(), stdout);
    return;
  }
  std::fputs(comparison_text(all).c_str(), stdout);
  if (is_sequence)
    for (std::size_t i = 0; i < images; ++i) std::fputs(sequences_text(o.files[i], found[i]).c_str(), stdout);
}

}  // namespace

void setup_compare(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* sub = app.add_subcommand("compare", "Measures the error of images against a converged reference");
  sub->add_option("files", o->files, "One or more images, then the reference; or sequences such as clean.####.exr")
      ->required()
      ->type_name("IMAGE... REFERENCE");
  sub->add_flag("--json", o->json, "Print JSON");
  sub->add_option("--html", o->html, "Write the figures and pictures as one HTML page to look into")->type_name("FILE");
  sub->add_option(
         "--error-map", o->error_maps,
         "Error map of an image, shown in the page with its reliability (repeatable, in the order of the images)")
      ->expected(1)
      ->take_all()
      ->type_name("FILE");
  sub->add_option("--frames", o->frames, "Frames of sequences; default: those that all sequences have")
      ->type_name("RANGES");
  add_page_size(*sub, o->max_size);
  sub->add_option("--picture", o->picture,
                  "Write a picture (.png, .jpg or .tif) of the reference, the images and their errors")
      ->type_name("FILE");
  add_overwrite(*sub, o->overwrite);
  add_display_options(*sub, o->display);
  add_memory_limit(*sub, o->max_memory);
  sub->footer(
      fmt::format("relMSE is the mean over pixels and RGB of ((x - r)^2 - Var(r)) / (r^2 + {:g}), with Var(r) from the "
                  "reference's\n",
                  relmse_floor) +
      "variance layer. trimmed is relMSE without the 0.1 % worst pixels. energy is mean(x) / mean(r) - 1. FLIP is the\n"
      "mean of HDR-FLIP, the difference that a viewer notices when the pictures alternate, 0 to 1. bad is the number "
      "of\n"
      "pixels that are not finite.\n"
      "Examples:\n"
      "  polyrecon compare clean.exr reference.exr\n"
      "  polyrecon compare noisy.exr clean.exr other.exr reference.exr --json\n"
      "  polyrecon compare noisy.exr clean.exr reference.exr --html compared.html --exposure 1\n"
      "  polyrecon compare clean.####.exr ref.####.exr --html compared.html");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
