#pragma once

#include <string>
#include <vector>

#include "c_api/filter.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// A filter that reads a frame from a file: its parameters name the file and choose the file's layers.
class ReadingFilter : public Filter {
 protected:
  ReadingFilter() {
    add_for_run("input", Parameter::of(input_));
    add("view layer", Parameter::of(options_.view_layer));
    add("view", Parameter::of(options_.view));
    add("map", Parameter::of(map_));
    add("aov", Parameter::of(options_.aovs));
    add("samples", Parameter::of(options_.samples, 0, Parameter::no_limit, true));
  }

  const std::string& input_path() const { return input_; }
  /// Whether a parameter chooses layers, which only a file has.
  bool chooses_layers() const {
    return !map_.empty() || !options_.aovs.empty() || !options_.view_layer.empty() || !options_.view.empty();
  }
  /// Throws Error{Usage} where the parameter "map" is wrong.
  ReadOptions read_options() const {
    ReadOptions options = options_;
    for (const std::string& role : map_) options.map.push_back(parse_mapping(role));
    return options;
  }

 private:
  std::string input_;
  std::vector<std::string> map_;
  ReadOptions options_;
};

}  // namespace polyrecon
