#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "c_api/memory_image.h"
#include "polyrecon/error.h"
#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// A parameter of a filter. Exactly one of number, text and texts is set.
struct Parameter {
  static constexpr double no_limit = 1e18;  ///< As the most of a number.

  std::function<void(double)> number;                ///< Takes the value.
  std::function<void(const std::string*)> text;      ///< Takes the value; null: the default.
  std::vector<std::string>* texts = nullptr;         ///< Gets one more value with each call.
  std::function<std::vector<std::string>()> values;  ///< The values as texts.

  /// A number from least to most, whole unless `fraction`.
  static Parameter of(double& value, double least, double most, bool fraction = false);
  static Parameter of(bool& value);
  static Parameter of(std::string& value);
  static Parameter of(std::vector<std::string>& values);
};

/// A kind of work of the C interface (include/polyrecon/polyrecon.h). It throws Error where the interface returns one.
class Filter {
 public:
  virtual ~Filter() = default;
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  /// Sets an input image; an image without data removes it. Throws Error{Usage} for a name that the filter does not
  /// have and for an invalid image.
  void set_image(const std::string& name, const MemoryImage& image);
  void set_text(const std::string& name, const std::string* value);
  void set_number(const std::string& name, double value);

  /// Threads to use; 0: as many as there are processors.
  int threads() const { return static_cast<int>(threads_); }

  /// Does the work. If it throws, the results of an earlier call are gone too.
  void execute(Progress& progress);

  const std::vector<NamedImage>& images() const { return images_; }
  const Image& image(const std::string& name) const;
  const std::string& report() const { return report_; }

  /// A message with the names of parameters in place of those of the program's options: "--max-memory 2G" becomes
  /// "'max memory' 2G".
  std::string in_parameters(const std::string& message) const;

 protected:
  Filter();

  /// The results of run.
  struct Made {
    std::vector<NamedImage> images;
    nlohmann::ordered_json report = nlohmann::ordered_json::object();
  };

  /// Throws Error{Usage} unless the filter takes an image of this name.
  virtual void check_image(const std::string& name) const = 0;
  virtual Made run(Progress& progress) = 0;

  /// Adds a parameter that the result depends on.
  void add(const std::string& name, Parameter parameter);
  /// Adds a parameter that names files or says how the filter runs: it is not among the settings.
  void add_for_run(const std::string& name, Parameter parameter) { parameters_.emplace(name, std::move(parameter)); }
  /// The parameters that the result depends on and whose values differ from the defaults: "quality 'draft', stages
  /// '2'".
  std::string settings() const;
  const std::map<std::string, MemoryImage>& inputs() const { return inputs_; }
  /// The image of this name; empty without one.
  Image input(const std::string& name) const;

 private:
  Parameter& parameter(const std::string& name);
  /// The same for the notes and reasons of a report.
  void name_parameters(nlohmann::ordered_json& report) const;

  std::map<std::string, Parameter> parameters_;
  std::map<std::string, std::vector<std::string>> defaults_;  ///< For those that the result depends on.
  std::map<std::string, MemoryImage> inputs_;
  std::vector<NamedImage> images_;
  std::string report_;
  double threads_ = 0;
};

/// The kinds of filters by name.
const std::map<std::string, std::function<std::unique_ptr<Filter>()>>& filter_kinds();

std::unique_ptr<Filter> make_denoise_filter();
std::unique_ptr<Filter> make_sample_map_filter();
std::unique_ptr<Filter> make_read_filter();
std::unique_ptr<Filter> make_write_filter();
std::unique_ptr<Filter> make_merge_filter();

}  // namespace polyrecon
