#include "manual/completion.h"

#include <fmt/format.h>

#include <vector>

namespace polyrecon {
namespace {

std::vector<std::string> names_of(const std::vector<CommandInfo>& commands) {
  std::vector<std::string> names;
  for (const CommandInfo& command : commands) names.push_back(command.name);
  return names;
}

std::vector<std::string> names_of(const std::vector<OptionInfo>& options) {
  std::vector<std::string> names;
  for (const OptionInfo& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

/// Quoted by '...', where a quote inside ends and reopens the quotes.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "'" + out + "'";
}

/// The shell function that offers the values of an option.
std::string bash_values(const OptionInfo& option) {
  if (!option.choices().empty()) return fmt::format("_polyrecon_words '{}'", fmt::join(option.choices(), " "));
  return option.takes_file() ? "_polyrecon_files" : ":";
}

std::string bash_command(const CommandInfo& command) {
  std::string text = fmt::format("    {})\n      case $before in\n", command.name);
  for (const OptionInfo& option : command.options)
    if (!option.is_flag())
      text += fmt::format("        {}) {}; return ;;\n", fmt::join(option.names, "|"), bash_values(option));
  text += "      esac\n";
  return text + fmt::format("      options='{}' ;;\n", fmt::join(names_of(command.options), " "));
}

/// An argument of zsh's _arguments: '*'{-o,--output}'[help]:FILE:_files'.
std::string zsh_argument(const OptionInfo& option) {
  std::string help;
  for (const char c : option.help) help += c == '[' || c == ']' || c == ':' ? std::string("\\") + c : std::string(1, c);
  std::string value;
  if (!option.is_flag()) {
    const std::vector<std::string> choices = option.choices();
    const std::string action = !choices.empty()      ? fmt::format("({})", fmt::join(choices, " "))
                               : option.takes_file() ? "_files"
                                                     : " ";
    value = fmt::format(":{}:{}", choices.empty() ? option.value : "name", action);
  }
  if (option.names.empty()) return quoted("*" + value);
  const std::string names =
      option.names.size() > 1 ? fmt::format("{{{}}}", fmt::join(option.names, ",")) : option.names.front();
  return fmt::format("'*'{}{}", names, quoted("[" + help + "]" + value));
}

std::string fish_option(const std::string& condition, const OptionInfo& option) {
  std::string text = fmt::format("complete -c polyrecon -n {}", quoted(condition));
  for (const std::string& name : option.names)
    text += name.compare(0, 2, "--") == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.is_flag()) {
    const std::vector<std::string> choices = option.choices();
    text += option.takes_file() ? " -r -F" : " -x";
    if (!choices.empty()) text += fmt::format(" -a '{}'", fmt::join(choices, " "));
  }
  // In fish, a backslash escapes quotes and backslashes.
  std::string help;
  for (const char c : option.help) help += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return text + fmt::format(" -d '{}'\n", help);
}

}  // namespace

std::string bash_completion(const CommandInfo& program) {
  std::string cases;
  for (const CommandInfo& command : program.commands) cases += bash_command(command);
  return fmt::format(R"(# Completion of polyrecon for bash; written by polyrecon_manual.
_polyrecon_words() {{
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "${{COMP_WORDS[COMP_CWORD]}}")
}}
_polyrecon_files() {{
  compopt -o filenames
  mapfile -t COMPREPLY < <(compgen -f -- "${{COMP_WORDS[COMP_CWORD]}}")
}}
_polyrecon() {{
  local before=${{COMP_WORDS[COMP_CWORD-1]}} options
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    _polyrecon_words '{} {}'
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}    *) return ;;
  esac
  if [[ ${{COMP_WORDS[COMP_CWORD]}} == -* ]]; then
    _polyrecon_words "$options"
  else
    _polyrecon_files
  fi
}}
complete -F _polyrecon polyrecon
)",
                     fmt::join(names_of(program.commands), " "), fmt::join(names_of(program.options), " "), cases);
}

std::string zsh_completion(const CommandInfo& program) {
  std::string commands, cases;
  for (const CommandInfo& command : program.commands) {
    commands += fmt::format("    {}\n", quoted(command.name + ":" + command.summary));
    std::string arguments;
    for (const auto* list : {&command.options, &command.positionals})
      for (const OptionInfo& option : *list) arguments += fmt::format(" \\\n        {}", zsh_argument(option));
    cases += fmt::format("    {})\n      _arguments -s{} ;;\n", command.name, arguments);
  }
  return fmt::format(R"(#compdef polyrecon
# Completion of polyrecon for zsh; written by polyrecon_manual.
_polyrecon() {{
  local -a commands=(
{})
  if (( CURRENT == 2 )); then
    _describe command commands
    compadd -- {}
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_polyrecon "$@"
)",
                     commands, fmt::join(names_of(program.options), " "), cases);
}

std::string fish_completion(const CommandInfo& program) {
  std::string text = "# Completion of polyrecon for fish; written by polyrecon_manual.\n";
  for (const CommandInfo& command : program.commands)
    text += fmt::format("complete -c polyrecon -f -n __fish_use_subcommand -a {} -d {}\n", command.name,
                        quoted(command.summary));
  for (const OptionInfo& option : program.options) text += fish_option("__fish_use_subcommand", option);
  for (const CommandInfo& command : program.commands)
    for (const OptionInfo& option : command.options)
      text += fish_option("__fish_seen_subcommand_from " + command.name, option);
  return text;
}

}  // namespace polyrecon
