#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/denoiser_options.h"
#include "cli/common/memory_limit.h"
#include "cli/common/printed_text.h"
#include "cli/common/read_limits.h"
#include "cli/inspect/report.h"
#include "io/layers/layer_words.h"
#include "io/layers/pass_advice.h"
#include "pipeline/part_of_beauty.h"
#include "pipeline/savings.h"
#include "pipeline/survey.h"
#include "polyrecon/error.h"
#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "presets/settings_choice.h"

namespace polyrecon {
namespace {

struct InspectOptions {
  std::string input;
  ReadOptions read;
  DenoiserOptions denoiser;
  bool json = false;
  std::size_t max_memory = default_memory();
};

/// The steps that denoise would run, and the time that each skipped one would take at standard quality, as a pilot on
/// some tiles predicts it. Fireflies are not looked for.
std::vector<Decision> decide_steps(Frame& frame) {
  const double seconds = standard_seconds(run_pilot(frame, silent_progress()), measured_figures());
  const Params params = params_for(Quality::Standard);
  std::vector<Decision> decisions = survey_frame(frame, params.steps, silent_progress()).preparation.decisions;
  estimate_savings(frame, params.prefilter, 0, seconds, decisions);
  return decisions;
}

/// The light layers that are no part of the beauty: of those that the user names, else of all.
std::vector<std::string> light_outside_beauty(const InspectOptions& o, const Inspection& found) {
  const auto& layers = found.source.layers;
  if (!o.read.aovs.empty() || std::none_of(layers.begin(), layers.end(), is_light_aov))
    return layers_outside_beauty(*found.frame);
  ReadOptions options = o.read;
  options.aovs = {"all"};
  return layers_outside_beauty(read_frame(o.input, options).frame);
}

std::vector<FoundDenoiser> find_denoisers(const DenoiserOptions& options) {
  std::vector<FoundDenoiser> found;
  for (const auto& [option, make] : denoisers()) {
    FoundDenoiser& one = found.emplace_back();
    one.option = option;
    try {
      const auto denoiser = make(options);
      one.name = denoiser->name();
      one.place = denoiser->place();
    } catch (const Error& error) {
      one.problem = error.what();
    }
  }
  return found;
}

void run(const InspectOptions& o) {
  limit_memory(o.max_memory);
  require_readable(o.input);
  InspectReport report{inspect(o.input, o.read), {}, find_denoisers(o.denoiser)};
  if (report.file.frame) try {
      for (const std::string& layer : light_outside_beauty(o, report.file))
        report.file.notes.push_back(note_of_layer_outside_beauty(layer));
      report.steps = decide_steps(*report.file.frame);
    } catch (const Error& problem) {
      if (problem.code() != ExitCode::CheckFailed) throw;
      report.file.notes.emplace_back(problem.what());
    }
  const Inspection& found = report.file;
  report.advice = pass_advice(found.source, found.samples, oidn_is_installed(o.denoiser.oidn.path));
  const std::string text = o.json ? json_text(inspect_json(report)) : inspect_text(report);
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void setup_inspect(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<InspectOptions>();
  CLI::App* sub = app.add_subcommand("inspect", "Lists the layers of a file and the role of each");
  sub->add_option("file", o->input, "Render to inspect")->required()->type_name("FILE");
  sub->add_flag("--json", o->json, "Print JSON");
  sub->add_option("--view-layer", o->read.view_layer, "View layer whose layers get roles, in place of the first one")
      ->type_name("NAME");
  sub->add_option("--view", o->read.view, "Stereo view whose layers get roles, in place of the first one")
      ->type_name("NAME");
  sub->add_option("-l,--aov", o->read.aovs,
                  "Colour layers that denoise is to take too, as its --aov names them (repeatable)")
      ->type_name("LAYER");
  OptionSet set(*sub);
  add_denoiser_options(set, o->denoiser);
  add_memory_limit(*sub, o->max_memory);
  add_read_limits(set, o->read.limits);
  sub->footer(
      "Examples:\n"
      "  polyrecon inspect render.exr\n"
      "  polyrecon inspect render.exr --json");
  set_callback<InspectOptions>(*sub, o, run, nullptr, chosen);
}

}  // namespace polyrecon
