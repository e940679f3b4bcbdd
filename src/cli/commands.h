#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace polyrecon {

/// The work of the command that was parsed. It runs after the parsing, so that its errors are not reported as the
/// parser's.
using Command = std::function<void()>;

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
