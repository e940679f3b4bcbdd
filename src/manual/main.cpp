// Writes the man pages and shell completions below a folder, laid out as below /usr/share: polyrecon_manual FOLDER
// Writes the page docs/reference/command_line.md: polyrecon_manual --markdown FILE

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
#include "manual/markdown_page.h"

namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  if (!(file << text).flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

polyrecon::CommandInfo program_of_command_line() {
  CLI::App app;
  polyrecon::Command unused;
  polyrecon::setup_app(app, unused);
  return polyrecon::describe(app);
}

void write_all(const polyrecon::CommandInfo& program, const fs::path& folder) {
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
    const polyrecon::CommandInfo program = program_of_command_line();
    if (argc == 3 && std::string(argv[1]) == "--markdown")
      write(argv[2], polyrecon::markdown_page(program));
    else if (argc == 2 && argv[1][0] != '-')
      write_all(program, argv[1]);
    else
      throw std::runtime_error("give the folder to write to, or --markdown and the page");
    return 0;
  } catch (const std::exception& e) {
    std::fputs(fmt::format("polyrecon_manual: {}\n", e.what()).c_str(), stderr);
    return 1;
  }
}
