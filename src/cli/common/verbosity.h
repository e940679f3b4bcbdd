#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace polyrecon {

/// How much a command prints on standard output.
enum class Verbosity {
  Quiet,  ///< Nothing. Errors and missed targets still stand on standard error.
  Short,  ///< The layers read, the work done, and advice.
  Full    ///< All figures.
};

/// Adds -q below this heading of the help.
void add_quiet(CLI::App& app, Verbosity& verbosity, const std::string& group = "Options");

/// Adds -q and -v, which exclude each other.
void add_verbosity(CLI::App& app, Verbosity& verbosity, const std::string& group = "Options");

}  // namespace polyrecon
