#include "c_api/filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace polyrecon {
namespace {

constexpr double most_threads = 4096;

}  // namespace

Parameter Parameter::of(double& value, double least, double most, bool fraction) {
  Parameter parameter;
  parameter.number = [=, &value](double given) {
    if (given < least || given > most)
      throw Error(ExitCode::Usage, fmt::format("{:g} is not between {:g} and {:g}", given, least, most));
    if (!fraction && given != std::floor(given))
      throw Error(ExitCode::Usage, fmt::format("{:g} is no whole number", given));
    value = given;
  };
  parameter.values = [&value] { return std::vector<std::string>{fmt::format("{}", value)}; };
  return parameter;
}

Parameter Parameter::of(bool& value) {
  Parameter parameter;
  parameter.number = [&value](double given) {
    if (given != 0 && given != 1) throw Error(ExitCode::Usage, fmt::format("{:g} is neither 0 nor 1", given));
    value = given == 1;
  };
  parameter.values = [&value] { return std::vector<std::string>{value ? "1" : "0"}; };
  return parameter;
}

Parameter Parameter::of(std::string& value) {
  Parameter parameter;
  parameter.text = [&value, initial = value](const std::string* given) { value = given ? *given : initial; };
  parameter.values = [&value] { return std::vector<std::string>{value}; };
  return parameter;
}

Parameter Parameter::of(std::vector<std::string>& values) {
  Parameter parameter;
  parameter.texts = &values;
  parameter.values = [&values] { return values; };
  return parameter;
}

Filter::Filter() { add_for_run("threads", Parameter::of(threads_, 0, most_threads)); }

void Filter::add(const std::string& name, Parameter parameter) {
  defaults_.emplace(name, parameter.values());
  parameters_.emplace(name, std::move(parameter));
}

std::string Filter::settings() const {
  std::vector<std::string> found;
  for (const auto& [name, initial] : defaults_)
    if (const std::vector<std::string> values = parameters_.at(name).values(); values != initial)
      for (const std::string& value : values) found.push_back(fmt::format("{} '{}'", name, value));
  return fmt::format("library: {}", fmt::join(found, ", "));
}

Parameter& Filter::parameter(const std::string& name) {
  const auto found = parameters_.find(name);
  if (found != parameters_.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& entry : parameters_) known.push_back(entry.first);
  throw Error(ExitCode::Usage, fmt::format("no parameter '{}'; there are: {}", name, fmt::join(known, ", ")));
}

void Filter::set_image(const std::string& name, const MemoryImage& image) {
  check_image(name);
  if (!image.data) {
    inputs_.erase(name);
    return;
  }
  check(name, image);
  inputs_[name] = image;
}

void Filter::set_text(const std::string& name, const std::string* value) {
  const Parameter& found = parameter(name);
  if (found.texts) {
    if (value)
      found.texts->push_back(*value);
    else
      found.texts->clear();
    return;
  }
  if (!found.text) throw Error(ExitCode::Usage, fmt::format("parameter '{}' is a number", name));
  found.text(value);
}

void Filter::set_number(const std::string& name, double value) {
  const Parameter& found = parameter(name);
  if (!found.number) throw Error(ExitCode::Usage, fmt::format("parameter '{}' is a text", name));
  if (!std::isfinite(value)) throw Error(ExitCode::Usage, fmt::format("parameter '{}' is not finite", name));
  try {
    found.number(value);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("parameter '{}': {}", name, error.what()));
  }
}

void Filter::execute(Progress& progress) {
  images_.clear();
  report_.clear();
  Made made = run(progress);
  name_parameters(made.report);
  // Names of layers may be no UTF-8; the JSON has to be.
  report_ = made.report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  images_ = std::move(made.images);
}

std::string Filter::in_parameters(const std::string& message) const {
  std::string text;
  std::size_t done = 0;
  for (std::size_t option = message.find("--"); option != std::string::npos; option = message.find("--", option + 2)) {
    const std::size_t end =
        std::min(message.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", option + 2), message.size());
    std::string name = message.substr(option + 2, end - option - 2);
    std::replace(name.begin(), name.end(), '-', ' ');
    const bool begins_word = option == 0 || message[option - 1] == ' ';
    if (!begins_word || parameters_.count(name) == 0) continue;
    text += message.substr(done, option - done) + "'" + name + "'";
    done = end;
  }
  return text + message.substr(done);
}

void Filter::name_parameters(nlohmann::ordered_json& report) const {
  const auto name_in = [&](nlohmann::ordered_json& text) { text = in_parameters(text.get<std::string>()); };
  if (report.contains("notes"))
    for (nlohmann::ordered_json& note : report["notes"]) name_in(note);
  if (report.contains("decisions"))
    for (nlohmann::ordered_json& decision : report["decisions"]) name_in(decision["reason"]);
}

const Image& Filter::image(const std::string& name) const {
  const auto found = std::find_if(images_.begin(), images_.end(), [&](const NamedImage& i) { return i.name == name; });
  if (found != images_.end()) return found->image;
  std::vector<std::string> names;
  for (const NamedImage& made : images_) names.push_back(made.name);
  throw Error(ExitCode::Missing, names.empty()
                                     ? fmt::format("no image '{}': the filter has made none", name)
                                     : fmt::format("no image '{}'; there are: {}", name, fmt::join(names, ", ")));
}

Image Filter::input(const std::string& name) const {
  const auto found = inputs_.find(name);
  return found == inputs_.end() ? Image() : read_memory(found->second);
}

const std::map<std::string, std::function<std::unique_ptr<Filter>()>>& filter_kinds() {
  static const std::map<std::string, std::function<std::unique_ptr<Filter>()>> kinds{
      {"denoise", make_denoise_filter}, {"sample map", make_sample_map_filter}, {"read", make_read_filter},
      {"write", make_write_filter},     {"merge", make_merge_filter},
  };
  return kinds;
}

}  // namespace polyrecon
