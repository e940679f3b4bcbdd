// Writes the man pages and shell completions below a folder, laid out as below /usr/share: polyrecon_manual FOLDER

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "cli/app.h"
#include "manual/command_line.h"
#include "manual/completion.h"
#include "manual/man_page.h"

namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  if (!(file << text).flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

void write_all(const fs::path& folder) {
  CLI::App app;
  polyrecon::Command unused;
  polyrecon::setup_app(app, unused);
  const polyrecon::CommandInfo program = polyrecon::describe(app);
  const fs::path pages = folder / "man" / "man1";
  write(pages / "polyrecon.1", polyrecon::program_page(program, POLYRECON_VERSION));
  for (const polyrecon::CommandInfo& command : program.commands)
    write(pages / fmt::format("polyrecon-{}.1", command.name),
          polyrecon::command_page(program, command, POLYRECON_VERSION));
  write(folder / "bash-completion" / "completions" / "polyrecon", polyrecon::bash_completion(program));
  write(folder / "zsh" / "site-functions" / "_polyrecon", polyrecon::zsh_completion(program));
  write(folder / "fish" / "vendor_completions.d" / "polyrecon.fish", polyrecon::fish_completion(program));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("give the folder to write to");
    write_all(argv[1]);
    return 0;
  } catch (const std::exception& e) {
    std::fputs(fmt::format("polyrecon_manual: {}\n", e.what()).c_str(), stderr);
    return 1;
  }
}
