#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/display_options.h"
#include "cli/common/memory_limit.h"
#include "cli/common/numbers.h"
#include "cli/common/printed_text.h"
#include "cli/common/sequence_arguments.h"
#include "cli/view/viewed_files.h"
#include "html/viewer_page.h"
#include "io/files/atomic_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct ViewOptions {
  std::vector<std::string> files, layers;
  std::string output, reference, frames, region, page;
  DisplayParams display;
  int scale = 1;
  bool overwrite = false;
  std::size_t max_size = default_page_size;
  std::size_t max_memory = default_memory();
};

/// "X,Y,WIDTH,HEIGHT"
std::optional<Rect> parse_region(const std::string& text) {
  if (text.empty()) return std::nullopt;
  Rect r;
  int width = 0, height = 0, used = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d,%d%n", &r.x0, &r.y0, &width, &height, &used) != 4 ||
      static_cast<std::size_t>(used) != text.size() || width < 1 || height < 1 || width > 1 << 20 || height > 1 << 20 ||
      std::abs(r.x0) > 1 << 28 || std::abs(r.y0) > 1 << 28)
    throw Error(ExitCode::Usage, fmt::format("--region {}: it must be X,Y,WIDTH,HEIGHT in pixels", text));
  r.x1 = r.x0 + width;
  r.y1 = r.y0 + height;
  return r;
}

/// The contents of a page: those of the command line, or of a file that --page names.
struct PageContents {
  std::string title, subtitle = "polyrecon " POLYRECON_VERSION, report;
  std::string frame_name = "frame";
  std::vector<std::string> frames;
  std::vector<ViewedImage> images;
  std::vector<ViewedFile> files;
  bool first_layers_only = false;
};

PageContents contents_of_arguments(const ViewOptions& o) {
  std::vector<std::string> texts = o.files;
  if (!o.reference.empty()) texts.push_back(o.reference);
  const std::vector<SequenceArgument> arguments = sequence_arguments(texts);
  const std::vector<int> numbers = common_frames(arguments, o.frames);
  const std::vector<std::string> names = short_names(texts);
  PageContents page;
  page.title = names.size() == 1 ? names[0] : fmt::format("{} and {} more", names[0], names.size() - 1);
  for (const int number : numbers) page.frames.push_back(std::to_string(number));
  std::vector<std::size_t> all(std::max<std::size_t>(numbers.size(), 1));
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    page.images.push_back({names[i], texts[i], !o.reference.empty() && i + 1 == arguments.size()});
    if (!arguments[i].pattern) {
      page.files.push_back({texts[i], i, all});
      continue;
    }
    for (const std::size_t k : all) page.files.push_back({arguments[i].pattern->path(numbers[k]), i, {k}});
  }
  return page;
}

/// The text of a description. Files of the system may be of no size and without an end, so no more than the size is
/// read.
std::string text_of_page_file(const std::string& path) {
  constexpr std::uintmax_t most = std::uintmax_t{64} << 20;
  require_readable(path);
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure || size == 0 || size > most)
    throw Error(ExitCode::BadInput,
                fmt::format("{}: no description of a page: it is empty or larger than {} MB", path, most >> 20));
  std::string text(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw Error(ExitCode::BadInput, path + ": cannot be read");
  return text;
}

/// Reads what docs/reference/view.md describes.
PageContents contents_of_page_file(const std::string& path) {
  const std::string text = text_of_page_file(path);
  PageContents page;
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    page.title = json.at("title").get<std::string>();
    page.subtitle = json.value("subtitle", page.subtitle);
    page.report = json.value("report", "");
    page.frame_name = json.value("frame_name", page.frame_name);
    page.frames = json.value("frames", std::vector<std::string>());
    page.first_layers_only = json.value("first_layers_only", false);
    const std::size_t count = std::max<std::size_t>(page.frames.size(), 1);
    for (const nlohmann::json& image : json.at("images")) {
      const std::size_t index = page.images.size();
      page.images.push_back({image.at("name").get<std::string>(), "", image.value("reference", false)});
      const nlohmann::json& files = image.at("files");
      if (files.size() != count)
        throw Error(ExitCode::BadInput, fmt::format("{}: image '{}' has {} files for {} frames", path,
                                                    page.images.back().name, files.size(), count));
      for (std::size_t k = 0; k < count; ++k)
        if (!files[k].is_null()) page.files.push_back({files[k].get<std::string>(), index, {k}});
    }
  } catch (const nlohmann::json::exception& e) {
    throw Error(ExitCode::BadInput, fmt::format("{}: no description of a page: {}", path, e.what()));
  }
  return page;
}

void check(const ViewOptions& o) {
  if (o.files.empty() == o.page.empty())
    throw Error(ExitCode::Usage, "view needs the files to show, or --page with a description of the page");
  if (!o.page.empty() && !(o.reference.empty() && o.frames.empty()))
    throw Error(ExitCode::Usage,
                "--page names the reference and the frames itself: leave out --reference and --frames");
  parse_region(o.region);
  require_endings({{"-o", o.output, FileKind::Page}});
}

void run(const ViewOptions& o) {
  limit_memory(o.max_memory);
  check(o);
  const PageContents contents = o.page.empty() ? contents_of_arguments(o) : contents_of_page_file(o.page);
  const ViewSelection selection{o.layers, contents.first_layers_only, parse_region(o.region), o.scale, o.max_size};
  std::vector<std::string> paths;
  for (const ViewedFile& file : contents.files) {
    require_readable(file.path);
    paths.push_back(file.path);
  }
  if (!o.page.empty()) paths.push_back(o.page);
  require_outputs(paths, {{"-o", o.output, FileKind::Page}}, o.overwrite);

  ViewerPage page(contents.title, o.display, o.max_size);
  if (!contents.frames.empty()) page.set_frames(contents.frame_name, contents.frames);
  for (const ViewedImage& image : contents.images) page.add_image(image);
  for (const std::string& note : add_files(page, contents.files, selection)) {
    page.add_note(note);
    std::fputs(text_line("polyrecon: {}", note).c_str(), stderr);
  }
  if (o.scale > 1) page.add_note(fmt::format("Each pixel is the mean of {0} x {0} pixels of the files.", o.scale));
  if (!o.region.empty()) page.add_note("The page holds a part of the files: x, y, width, height " + o.region + ".");
  write_bytes(o.output, page.html(contents.subtitle, contents.report));
}

}  // namespace

void setup_view(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<ViewOptions>();
  CLI::App* sub = app.add_subcommand("view", "Makes an HTML page in which to look at images and maps, pixel by pixel");
  sub->add_option("files", o->files, "Images or maps of one frame, or sequences of them such as clean.####.exr")
      ->type_name("FILE...");
  sub->add_option("-o,--output", o->output, "HTML page to write")->required()->type_name("FILE");
  sub->add_option("--reference", o->reference, "Converged render: the page shows errors relative to it")
      ->type_name("FILE");
  sub->add_option("--frames", o->frames, "Frames of sequences; default: those that all sequences have")
      ->type_name("RANGES");
  sub->add_option("--page", o->page, "Description of the page as JSON, in place of files: names, frames, text")
      ->type_name("FILE");
  sub->add_option("--layer", o->layers, "Layer to take in (repeatable); default: all layers of all files")
      ->expected(1)
      ->take_all()
      ->type_name("NAME");
  sub->add_option("--region", o->region, "Part of the pictures to take in, in pixels of the files")
      ->type_name("X,Y,WIDTH,HEIGHT");
  sub->add_option("--scale", o->scale, "Average N x N pixels to one")
      ->check(from_to(1, 64))
      ->type_name("N")
      ->capture_default_str();
  add_page_size(*sub, o->max_size);
  add_overwrite(*sub, o->overwrite);
  add_display_options(*sub, o->display);
  add_memory_limit(*sub, o->max_memory);
  sub->footer(
      "The page is one file, which any recent browser opens without a network. Press ? in it for its keys.\n"
      "Pictures are stored as half floats, maps as floats. Where the page would be larger than --max-size, layers are\n"
      "left out, those that are shown first last; a note says which.\n"
      "Examples:\n"
      "  polyrecon view noisy.exr clean.exr error.exr -o look.html\n"
      "  polyrecon view noisy.exr clean.exr other.exr --reference reference.exr -o look.html --view Filmic\n"
      "  polyrecon view noisy.####.exr clean.####.exr -o look.html --frames 1-20 --scale 2 --layer Combined");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
