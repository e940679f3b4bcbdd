#include "cli/common/option_set.h"

#include <algorithm>

#include "core/nearest.h"

namespace polyrecon {
namespace {

/// The text as one word of a shell.
std::string shell_word(const std::string& text) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> names) {
  return {[names = std::move(names)](std::string& text) {
            if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
            return fmt::format("{} is none of {}{}", text, fmt::join(names, ", "), did_you_mean(text, names));
          },
          ""};
}

CLI::Option* OptionSet::remember(Changes changes, CLI::Option* option, const Texts& texts, bool is_flag) {
  if (changes == Changes::Result) entries_.push_back({option->get_name(), texts, texts(), is_flag});
  return option->group(group_);
}

CLI::Option* OptionSet::add_flag(Changes changes, const std::string& names, bool& value, const std::string& help) {
  const auto texts = [&value] { return std::vector<std::string>(value ? 1 : 0, "on"); };
  return remember(changes, app_.add_flag(names, value, help), texts, true);
}

CLI::Option* OptionSet::add_alias(const std::string& names, const std::function<void(const std::string&)>& set,
                                  const std::string& help) {
  return app_.add_option_function<std::string>(names, set, help)->group(help.empty() ? "" : group_);
}

std::string OptionSet::identity(const std::map<std::string, std::string>& resolved) const {
  std::string text;
  for (const Entry& entry : entries_) {
    std::vector<std::string> values = entry.texts();
    const auto found = resolved.find(entry.name);
    if (found != resolved.end())
      values = {found->second};
    else if (values == entry.defaults)
      continue;
    for (const std::string& value : values)
      text += (text.empty() ? "" : " ") + entry.name + (entry.is_flag ? "" : " " + shell_word(value));
  }
  return text;
}

}  // namespace polyrecon
