#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/frame_names.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/denoise/fetch_frame.h"
#include "cli/denoise/file_run.h"
#include "cli/denoise/folder.h"
#include "cli/denoise/job.h"
#include "cli/denoise/sequence.h"
#include "core/parallel.h"
#include "io/files/file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Returns whether a limit was missed.
bool denoise_file(const Job& job, const FrameFiles& files, LoadedFrame loaded, FrameFetcher& fetcher,
                  RunProgress& progress) {
  FileRun run(job, files);
  for (;;) {
    run.list_others(loaded);
    run.denoise(std::move(loaded), job.params.max_memory, progress);
    const auto next = run.next();
    if (!next) break;
    loaded = fetcher.fetch(files, *next);
  }
  return run.write(progress);
}

/// Returns whether a limit was missed.
bool run_single(const Job& job, RunProgress& progress) {
  const FrameFiles& files = job.frames.front();
  progress.frame(files.label(), 0, 1);
  FrameFetcher fetcher(job, [&] { return progress.cancelled(); });
  bool missed = false;
  if (auto loaded = fetcher.fetch(files))
    missed = denoise_file(job, files, std::move(*loaded), fetcher, progress);
  else if (job.run.verbosity != Verbosity::Quiet)
    progress.print(stdout, text_line("{}: finished already", files.outputs.picture));
  progress.frame("", 1, 1);
  return missed;
}

/// Returns whether a limit was missed.
bool run_job(Job wanted, RunProgress& progress) {
  set_thread_limit(wanted.run.threads);
  set_codec_threads(wanted.run.threads > 0 ? wanted.run.threads : processors());
  const Job job = with_denoiser(std::move(wanted));
  if (job.run.dry_run) {
    show_dry_run(job);
    return false;
  }
  return job.is_sequence ? run_sequence(job, progress) : run_single(job, progress);
}

std::string contents_text(const std::string& folder, const FolderContents& contents, const std::vector<Job>& jobs) {
  std::string text = text_line("{}: {} to denoise", folder, contents.renders.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const FoundRender& render = contents.renders[i];
    const std::string& first = jobs[i].frames.front().outputs.picture;
    text += render.frames.empty() ? text_line("  {} -> {}", file_name(render.input), first)
                                  : text_line("  {}, {} frames {} -> {} ...", file_name(render.input),
                                              render.frames.size(), frames_text(render.frames), first);
  }
  for (const LeftOut& left : contents.left_out)
    text += text_line("  left out: {}, {}", file_name(left.input), left.why);
  return text;
}

/// All renders of a folder one after the other. One that fails is reported, and the others are still denoised. Returns
/// whether a limit was missed.
bool run_folder(const DenoiseOptions& options, const OptionSet& set, RunProgress& progress) {
  const std::string& folder = options.inputs.front();
  const FolderContents contents = find_renders(folder, options.read);
  std::vector<Job> jobs;
  for (const FoundRender& render : contents.renders) {
    DenoiseOptions one = options;
    one.inputs = {render.input};
    for (const OutputOption& option : output_options())
      if (std::string& path = one.outputs.*option.path; !path.empty()) {
        if (has_ending_of(file_kind_of(option.kind), path))
          throw Error(ExitCode::Usage,
                      fmt::format("{} {}: the input is a folder, so name a folder", option.name, path));
        if (path.back() != '/') path += '/';
      }
    jobs.push_back(make_job(one, set));
    check_files(jobs.back());
  }
  if (options.run.verbosity != Verbosity::Quiet) progress.print(stdout, contents_text(folder, contents, jobs));
  std::size_t failed = 0;
  bool missed = false;
  for (Job& job : jobs) try {
      missed = run_job(std::move(job), progress) || missed;
    } catch (const Error& error) {
      if (options.run.strict || !concerns_one_frame(error.code())) throw;
      progress.print(stderr, text_line("polyrecon: {}", error.what()));
      ++failed;
    }
  if (failed > 0)
    throw Error(ExitCode::Missing,
                fmt::format("{}: {} of {} renders are missing or broken", folder, failed, jobs.size()));
  return missed;
}

bool run_all(const DenoiseOptions& options, const OptionSet& set, RunProgress& progress) {
  if (std::error_code ignored;
      options.inputs.size() == 1 && std::filesystem::is_directory(options.inputs.front(), ignored))
    return run_folder(options, set, progress);
  Job job = make_job(options, set);
  check_files(job);
  return run_job(std::move(job), progress);
}

/// Returns the exit code.
int run(const DenoiseOptions& options, const OptionSet& set) {
  const bool quiet = options.run.verbosity == Verbosity::Quiet;
  const auto progress = make_progress(quiet ? ProgressStyle::None : options.run.progress);
  try {
    return run_all(options, set, *progress) && options.run.miss_fails ? exit_code_missed : 0;
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
      "  polyrecon denoise -i renders/ -o clean/\n"
      "  polyrecon denoise -i render.exr -o clean.exr --error-map error.exr --report report.json\n"
      "  polyrecon denoise -i render.exr -o clean.exr --sample-map samples.exr --budget 32\n"
      "  polyrecon denoise -i render.exr -o clean.exr --time-budget 10\n"
      "  polyrecon denoise -i render.exr -o clean.exr --target 0.002 --on-miss fail\n"
      "  polyrecon denoise -i render.exr -o clean.exr --aov 'Diffuse Direct' --aov 'Glossy Direct' --quality best\n"
      "  polyrecon denoise -i shot.####.exr -o clean/shot.####.exr --frames 1-10,20-40x2 --skip-existing\n"
      "  polyrecon denoise -i render.exr -o clean.exr --map albedo=ViewLayer.MyAlbedo --progress json");
  sub->callback([line, &chosen] {
    chosen = {[line] { return run(line->options, line->set); }, [line] { check_options(line->options); }};
  });
}

}  // namespace polyrecon
