#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

namespace polyrecon {

/// The exit code of a run whose --time-budget or --target was missed, with --on-miss fail: all outputs are written, so
/// it is no Error.
constexpr int exit_code_missed = 8;

/// The command that was parsed. Its work runs after the parsing, so that its errors are not reported as the parser's.
struct Command {
  std::function<int()> run;  ///< Returns the exit code where nothing went wrong.
  /// Throws Error{Usage} where the options contradict each other; looks at no file. May be empty.
  std::function<void()> check_options;
};

/// Parsing `sub` sets `chosen` to the work of a command whose exit code is always 0. check: null where no options
/// contradict each other.
template <typename Options>
void set_callback(CLI::App& sub, const std::shared_ptr<Options>& options, void (*run)(const Options&),
                  void (*check)(const Options&), Command& chosen) {
  sub.callback([=, &chosen] {
    chosen.run = [=] {
      run(*options);
      return 0;
    };
    if (check) chosen.check_options = [=] { check(*options); };
  });
}

/// Each adds one command to app, with its options and examples. Parsing that command sets `chosen`.
void setup_denoise(CLI::App& app, Command& chosen);
void setup_inspect(CLI::App& app, Command& chosen);
void setup_merge(CLI::App& app, Command& chosen);
void setup_samplemap(CLI::App& app, Command& chosen);
void setup_preview(CLI::App& app, Command& chosen);
void setup_view(CLI::App& app, Command& chosen);
void setup_compare(CLI::App& app, Command& chosen);
void setup_sweep(CLI::App& app, Command& chosen);

}  // namespace polyrecon
