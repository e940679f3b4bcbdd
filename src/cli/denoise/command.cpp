#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include "cli/commands.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/denoise/fetch_frame.h"
#include "cli/denoise/file_run.h"
#include "cli/denoise/job.h"
#include "cli/denoise/sequence.h"
#include "core/parallel.h"
#include "io/files/file.h"

namespace polyrecon {
namespace {

void denoise_file(const Job& job, const FrameFiles& files, LoadedFrame loaded, FrameFetcher& fetcher,
                  Progress& progress) {
  FileRun run(job, files);
  for (;;) {
    run.list_others(loaded);
    run.denoise(std::move(loaded), job.params.max_memory, progress);
    const auto next = run.next();
    if (!next) break;
    loaded = fetcher.fetch(files, *next);
  }
  run.write(progress);
}

void run_single(const Job& job, RunProgress& progress) {
  const FrameFiles& files = job.frames.front();
  progress.frame(files.label(), 0, 1);
  FrameFetcher fetcher(job, [&] { return progress.cancelled(); });
  if (auto loaded = fetcher.fetch(files))
    denoise_file(job, files, std::move(*loaded), fetcher, progress);
  else if (!job.run.quiet)
    std::fputs(text_line("{}: finished already", files.outputs.picture).c_str(), stdout);
  progress.frame("", 1, 1);
}

void run_job(Job job, RunProgress& progress) {
  check_files(job);
  set_thread_limit(job.run.threads);
  set_codec_threads(job.run.threads > 0 ? job.run.threads : processors());
  load_denoiser(job);
  if (job.run.dry_run) return show_dry_run(job);
  if (job.is_sequence) return run_sequence(job, progress);
  run_single(job, progress);
}

void run(const DenoiseOptions& options, const OptionSet& set) {
  const auto progress = make_progress(options.run.quiet ? ProgressStyle::None : options.run.progress);
  try {
    run_job(make_job(options, set), *progress);
  } catch (const std::exception& error) {
    progress->failed(error.what());
    throw;
  }
}

/// The option set refers to the options.
struct CommandLine {
  explicit CommandLine(CLI::App& app) : set(app) { add_denoise_options(set, options); }
  DenoiseOptions options;
  OptionSet set;
};

}  // namespace

void setup_denoise(CLI::App& app, Command& chosen) {
  CLI::App* sub = app.add_subcommand("denoise", "Denoises a render with the help of its feature passes");
  const auto line = std::make_shared<CommandLine>(*sub);
  sub->footer(
      "Examples:\n"
      "  polyrecon denoise -i render.exr -o clean.exr\n"
      "  polyrecon denoise -i render.exr -o clean.exr --error-map error.exr --report report.json\n"
      "  polyrecon denoise -i render.exr -o clean.exr --sample-map samples.exr --budget 32\n"
      "  polyrecon denoise -i render.exr -o clean.exr --time-budget 10\n"
      "  polyrecon denoise -i render.exr -o clean.exr --target 0.002\n"
      "  polyrecon denoise -i render.exr -o clean.exr --aov 'Diffuse Direct' --aov 'Glossy Direct' --quality best\n"
      "  polyrecon denoise -i shot.####.exr -o clean/shot.####.exr --frames 1-10,20-40x2 --skip-existing\n"
      "  polyrecon denoise -i render.exr -o clean.exr --map albedo=ViewLayer.MyAlbedo --progress json");
  sub->callback([line, &chosen] { chosen = [line] { run(line->options, line->set); }; });
}

}  // namespace polyrecon
