#include "cli/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "cli/app.h"
#include "core/nearest.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands(nullptr)) names.push_back(sub->get_name());
  return names;
}

/// What to say about a word that is no command.
std::string no_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names = command_names(app);
  names.emplace_back("help");
  return fmt::format("'{}' is no command{} (polyrecon --help lists the commands)", word, did_you_mean(word, names));
}

bool is_command(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> names = command_names(app);
  return std::find(names.begin(), names.end(), word) != names.end();
}

/// Whether a word where a command is expected is a file, a folder or a sequence.
bool is_path(const std::string& word) {
  std::error_code ignored;
  return word.find_first_of("./#%") != std::string::npos || std::filesystem::exists(word, ignored);
}

/// The words with what they are short for.
std::vector<std::string> expanded(const CLI::App& app, std::vector<std::string> words) {
  if (words.empty())
    throw Error(ExitCode::Usage,
                "name a render, as in polyrecon render.exr, or a command (polyrecon --help lists them)");
  if (words.size() > 1 && words.front() == "denoise" && !words[1].empty() && words[1].front() != '-')
    words.insert(words.begin() + 1, "-i");
  if (words.front() == "help") {
    words.erase(words.begin());
    if (words.size() > 1) words.resize(1);
    if (!words.empty() && !is_command(app, words.front())) throw Error(ExitCode::Usage, no_command(app, words.front()));
    words.emplace_back("--help");
    return words;
  }
  const auto first = std::find_if(words.begin(), words.end(), [](const std::string& w) { return w != check_options; });
  if (first != words.end() && (*first == "-i" || *first == "--input")) {
    words.insert(first, "denoise");
    return words;
  }
  if (first == words.end() || first->empty() || first->front() == '-' || is_command(app, *first)) return words;
  if (!is_path(*first)) throw Error(ExitCode::Usage, no_command(app, *first));
  words.insert(first, {"denoise", "-i"});
  return words;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The message about the first word that begins as an option and is none; empty where there is no such word.
std::string mistyped(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& w) { return w[0] == '-'; });
  if (option == words.end()) return "";
  return fmt::format("{} is no option{}{}", *option, command.get_parent() ? " of " + command.get_name() : "",
                     did_you_mean(option->substr(0, option->find('=')), option_names(command)));
}

/// The message about words that no option takes.
std::string unexpected(const CLI::App& app, const std::string& message) {
  const auto subs = app.get_subcommands();
  const CLI::App& place = subs.empty() ? app : *subs.front();
  if (place.remaining().empty()) return message;
  const std::string mistake = mistyped(place);
  return mistake.empty() ? fmt::format("'{}' was not expected", place.remaining().front()) : mistake;
}

/// The option whose name goes on where that of the first word of the message ends, as a question; empty where none
/// does.
std::string longer_option(const CLI::App& command, const std::string& message) {
  const std::string name = message.substr(0, message.find(' '));
  for (const std::string& option : option_names(command))
    if (option.size() == name.size() + 1 && option.compare(0, name.size(), name) == 0)
      return fmt::format("; did you mean {}?", option);
  return "";
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& words) {
  CLI::App app;
  Command chosen;
  setup_app(app, chosen);
  std::vector<std::string> reversed = expanded(app, words);
  std::reverse(reversed.begin(), reversed.end());
  const auto hint = [&] {
    const auto subs = app.get_subcommands();
    return subs.empty() ? std::string(" (polyrecon --help lists the commands)")
                        : fmt::format(" (polyrecon help {} lists the options)", subs.front()->get_name());
  };
  try {
    app.parse(reversed);
  } catch (const CLI::ExtrasError& e) {
    throw Error(ExitCode::Usage, unexpected(app, e.what()) + hint());
  } catch (const CLI::RequiredError& e) {  // The missing option may be there, misspelt.
    const auto subs = app.get_subcommands();
    const std::string mistake = subs.empty() ? "" : mistyped(*subs.front());
    throw Error(ExitCode::Usage, (mistake.empty() ? e.what() : mistake) + hint());
  } catch (const CLI::RequiresError& e) {
    throw Error(ExitCode::Usage, e.what() + longer_option(*app.get_subcommands().front(), e.what()) + hint());
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) throw Error(ExitCode::Usage, e.what() + hint());
    app.exit(e);
    return {};
  }
  if (app.count(check_options) == 0) return chosen;
  if (chosen.check_options) chosen.check_options();
  return {};
}

}  // namespace polyrecon
