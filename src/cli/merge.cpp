#include "polyrecon/merge.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/encoding_options.h"
#include "cli/common/memory_limit.h"
#include "cli/common/numbers.h"
#include "cli/common/option_set.h"
#include "cli/common/printed_text.h"
#include "cli/common/read_limits.h"
#include "cli/common/verbosity.h"
#include "core/parallel.h"
#include "io/files/file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

struct MergeCommandOptions {
  std::vector<std::string> inputs;
  std::string output;
  MergeOptions merge;
  bool overwrite = false;
  Verbosity verbosity = Verbosity::Short;
  std::size_t max_memory = default_memory();
};

void check(const MergeCommandOptions& o) {
  if (o.inputs.size() + o.merge.half_b.size() < 2) throw Error(ExitCode::Usage, "merge needs at least two renders");
  check_encoding(o.merge.encoding);
  require_endings({{"-o", o.output}});
}

void run(const MergeCommandOptions& o) {
  limit_memory(o.max_memory);
  check(o);
  std::vector<std::string> inputs = o.inputs;
  inputs.insert(inputs.end(), o.merge.half_b.begin(), o.merge.half_b.end());
  for (const std::string& input : inputs) require_readable(input);
  require_outputs(inputs, {{"-o", o.output}}, o.overwrite);
  set_codec_threads(processors());
  const MergeResult result = merge(o.inputs, o.output, o.merge);
  if (o.verbosity == Verbosity::Quiet) return;
  const std::string samples = result.samples > 0 ? fmt::format(", {:g} samples per pixel", result.samples) : "";
  std::string text = text_line("{}: {} renders{}", o.output, result.files, samples);
  const bool all = o.verbosity == Verbosity::Full;
  if (all)
    text += text_line("  {:<26} {}",
                      result.joined ? "joined:" : "mean, variance and halves:", fmt::join(result.merged, ", "));
  if (all && !result.kept.empty()) text += text_line("  from the first file:       {}", fmt::join(result.kept, ", "));
  if (!result.dropped.empty()) text += text_line("  not merged:                {}", fmt::join(result.dropped, ", "));
  for (const std::string& note : result.notes) text += text_line("  note: {}", note);
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void setup_merge(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<MergeCommandOptions>();
  CLI::App* sub = app.add_subcommand(
      "merge", "Merges renders of one frame into mean, variance and half buffers, and joins regions of it");
  sub->add_option("inputs", o->inputs,
                  "Subsets of one sample sequence, renders with different seeds, or regions of the frame")
      ->required()
      ->type_name("FILE...");
  sub->add_option("-o,--output", o->output, "EXR to write")->required()->type_name("FILE");
  sub->add_option(
         "--half-b", o->merge.half_b,
         "Renders of half B; FILE... are then half A. Both halves weigh the same whatever their sample counts, which "
         "keeps the mean unbiased where each half chose the sample counts of the other")
      ->type_name("FILE...");
  sub->add_option(
         "--samples", o->merge.samples,
         "Samples per pixel of each render, if the files are wrong: subsets by Blender 5 contain the number of "
         "the whole sequence")
      ->check(above_zero())
      ->type_name("N");
  OptionSet set(*sub);
  add_encoding_options(set, o->merge.encoding, "zip");
  add_overwrite(*sub, o->overwrite);
  add_verbosity(*sub, o->verbosity);
  add_memory_limit(*sub, o->max_memory);
  add_read_limits(set, o->merge.limits);
  sub->footer(
      "Examples:\n"
      "  polyrecon merge part*.exr -o merged.exr\n"
      "  polyrecon merge subset*.exr -o merged.exr --samples 2\n"
      "  polyrecon merge a*.exr --half-b b*.exr -o merged.exr");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
