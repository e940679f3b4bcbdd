#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/common/verbosity.h"

namespace polyrecon {

/// Whether the output files of a command depend on an option.
enum class Changes {
  Result,  ///< The samples, the channels or the metadata of an output file.
  Run      ///< Only which files are read and written, how the command runs, and what it prints.
};

/// Accepts these names only; the message about another one suggests the nearest.
CLI::Validator one_of(std::vector<std::string> names);

/// The names that an option takes and what they stand for, in the order in which the help shows them.
template <typename Choice>
using Choices = std::vector<std::pair<std::string, Choice>>;

/// Adds options to a command. Each option states whether the result depends on it, so that identity() is complete
/// without a second list of options.
class OptionSet {
 public:
  explicit OptionSet(CLI::App& app) : app_(app) {}

  /// The options that follow stand below this heading in the help; "Options" is CLI11's default.
  void begin_group(const std::string& heading) { group_ = heading; }

  /// An option with a value: a number, a text, a std::optional of one, or a vector of texts. The initial value is the
  /// default. `value` must outlive the parsing and identity().
  template <typename Value>
  CLI::Option* add(Changes changes, const std::string& names, Value& value, const std::string& help) {
    return remember(changes, app_.add_option(names, value, help), [&value] { return texts_of(value); });
  }

  /// -q and -v.
  void add_verbosity(Verbosity& verbosity) { polyrecon::add_verbosity(app_, verbosity, group_); }

  CLI::Option* add_flag(Changes changes, const std::string& names, bool& value, const std::string& help);

  /// An option that takes one of a few names and sets `value` to what the name stands for; Value may be a
  /// std::optional. The type reads "draft|standard", which the help shows and the shell completions offer. The initial
  /// value is the default that the help shows.
  template <typename Value, typename Choice>
  CLI::Option* add_choice(Changes changes, const std::string& names, Value& value, const Choices<Choice>& choices,
                          const std::string& help) {
    std::vector<std::string> keys;
    for (const auto& [key, unused] : choices) keys.push_back(key);
    const auto texts = [&value, choices] {
      for (const auto& [key, choice] : choices)
        if (value == choice) return std::vector<std::string>{key};
      return std::vector<std::string>{};
    };
    const auto set = [&value, choices](const std::string& typed) {
      for (const auto& [key, choice] : choices)
        if (key == typed) value = choice;
    };
    CLI::Option* option = app_.add_option_function<std::string>(names, set, help);
    option->check(one_of(keys))->type_name(fmt::format("{}", fmt::join(keys, "|")));
    if (const auto initial = texts(); !initial.empty()) option->default_str(initial.front());
    return remember(changes, option, texts);
  }

  /// Another way to set the value of an option that was added before; identity() names that option. An empty help hides
  /// the alias from the help, the man pages and the completions.
  CLI::Option* add_alias(const std::string& names, const std::function<void(const std::string&)>& set,
                         const std::string& help);

  /// The options that the result depends on and whose values differ from the defaults, as they stand on a command line.
  /// resolved: values by option, such as {"--stages", "2"}, that replace those of the command line and always appear.
  std::string identity(const std::map<std::string, std::string>& resolved = {}) const;

 private:
  /// The values of an option as text, none where it has none.
  using Texts = std::function<std::vector<std::string>()>;
  struct Entry {
    std::string name;  ///< "--stages"
    Texts texts;
    std::vector<std::string> defaults;
    bool is_flag;
  };

  CLI::Option* remember(Changes changes, CLI::Option* option, const Texts& texts, bool is_flag = false);

  static std::vector<std::string> texts_of(const std::string& value) { return {value}; }
  static std::vector<std::string> texts_of(const std::vector<std::string>& values) { return values; }
  template <typename Value>
  static std::vector<std::string> texts_of(const std::optional<Value>& value) {
    return value ? texts_of(*value) : std::vector<std::string>{};
  }
  template <typename Value, typename = std::enable_if_t<std::is_arithmetic_v<Value>>>
  static std::vector<std::string> texts_of(Value value) {
    return {fmt::format("{}", value)};
  }

  CLI::App& app_;
  std::string group_ = "Options";
  std::vector<Entry> entries_;  ///< Those of Changes::Result.
};

}  // namespace polyrecon
