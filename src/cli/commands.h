#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace polyrecon {

/// The work of the sub-command that was parsed; run after parsing, so that its errors are not the parser's.
using Command = std::function<void()>;

/// Each adds one sub-command to app, with its options and examples; parsing it sets chosen.
void setup_denoise(CLI::App& app, Command& chosen);
void setup_inspect(CLI::App& app, Command& chosen);
void setup_merge(CLI::App& app, Command& chosen);
void setup_samplemap(CLI::App& app, Command& chosen);
void setup_preview(CLI::App& app, Command& chosen);
void setup_compare(CLI::App& app, Command& chosen);
void setup_sweep(CLI::App& app, Command& chosen);

}  // namespace polyrecon
