#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/display_options.h"
#include "cli/common/layers.h"
#include "cli/common/memory_limit.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/compare/comparison.h"
#include "cli/compare/comparison_output.h"
#include "cli/compare/comparison_page.h"
#include "core/relmse.h"
#include "io/files/atomic_file.h"
#include "io/pictures/png_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct CompareOptions {
  std::vector<std::string> files;  ///< The last one is the reference.
  std::string html, picture;
  DisplayParams display;
  bool json = false;
  std::size_t max_memory = default_memory;
};

void run(const CompareOptions& o) {
  limit_memory(o.max_memory);
  if (o.files.size() < 2) throw Error(ExitCode::Usage, "compare needs at least two files: an image and the reference");
  for (const std::string& file : o.files) require_readable(file);
  require_outputs(o.files, {{"--html", o.html}, {"--picture", o.picture}});
  const std::string& reference_path = o.files.back();
  const bool with_images = !o.html.empty() || !o.picture.empty();
  const auto progress = make_progress(ProgressStyle::None);
  const LayeredFile reference = open_layers(reference_path);
  std::vector<Comparison> found;
  for (std::size_t i = 0; i + 1 < o.files.size(); ++i)
    for (Comparison& c : compare_files(open_layers(o.files[i]), reference, with_images, *progress))
      found.push_back(std::move(c));
  if (!o.html.empty()) write_bytes(o.html, comparison_page(reference_path, found, o.display));
  if (!o.picture.empty()) write_png(o.picture, comparison_picture(found, o.display));
  std::fputs((o.json ? json_text(comparison_json(reference_path, found)) : comparison_text(found)).c_str(), stdout);
}

}  // namespace

void setup_compare(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* sub = app.add_subcommand("compare", "Measures the error of images against a converged reference");
  sub->add_option("files", o->files, "One or more images, then the reference")
      ->required()
      ->type_name("IMAGE... REFERENCE");
  sub->add_flag("--json", o->json, "Print JSON");
  sub->add_option("--html", o->html, "Write the figures and pictures as one HTML page")->type_name("FILE");
  sub->add_option("--picture", o->picture, "Write a PNG of the reference, the images and their errors")
      ->type_name("FILE");
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
      "  polyrecon compare noisy.exr clean.exr reference.exr --html compared.html --exposure 1");
  sub->callback([o, &chosen] { chosen = [o] { run(*o); }; });
}

}  // namespace polyrecon
