#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "c_api/memory_frame.h"
#include "c_api/output_file.h"
#include "c_api/reading_filter.h"
#include "io/exr/compression.h"
#include "polyrecon/merge.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

void require_path(const std::string& path, const char* name) {
  if (path.empty()) throw Error(ExitCode::Usage, fmt::format("set the text '{}'", name));
}

[[noreturn]] void refuse_image(const std::string& name) {
  throw Error(ExitCode::Usage, fmt::format("no image '{}': the filter takes none", name));
}

/// Reads the passes of a frame, ready to be given to the filter "denoise".
class ReadFilter : public ReadingFilter {
 protected:
  void check_image(const std::string& name) const override { refuse_image(name); }

  Made run(Progress& /*progress*/) override {
    require_path(input_path(), "input");
    const ReadResult in = read_frame(input_path(), read_options());
    Made made;
    made.images = named_images(in.frame);
    auto layers = nlohmann::ordered_json::array();
    for (const RoleChoice& choice : in.source.chosen)
      layers.push_back({{"role", name_of(choice.role)},
                        {"holds", name_of(choice.companion)},
                        {"layer", choice.layer},
                        {"why", choice.why}});
    made.report = {{"input", input_path()},  {"view_layer", in.source.view_layer},
                   {"view", in.source.view}, {"wraps", in.frame.wraps},
                   {"roles", layers},        {"notes", in.notes}};
    return made;
  }
};

/// Writes images: as new layers of a copy of another file, or as a file of their own.
class WriteFilter : public Filter {
 public:
  WriteFilter() {
    add("output", Parameter::of(output_));
    add("like", Parameter::of(like_));
    add("view layer", Parameter::of(view_layer_));
    add("view", Parameter::of(view_));
    add("keep noisy", Parameter::of(keep_noisy_));
  }

 protected:
  void check_image(const std::string& name) const override {
    if (name.empty()) throw Error(ExitCode::Usage, "the name of an image is empty");
  }

  Made run(Progress& /*progress*/) override {
    require_path(output_, "output");
    require_exr_output(output_);
    if (inputs().empty()) throw Error(ExitCode::Usage, "there is no image to write");
    Made made;
    std::vector<std::string> notes;
    if (like_.empty())
      write_alone();
    else
      notes = write_copy();
    made.report = {{"output", output_}, {"notes", notes}};
    return made;
  }

 private:
  std::vector<std::string> write_copy() const {
    ReadOptions options;
    options.view_layer = view_layer_;
    options.view = view_;
    const ReadResult in = read_frame_header(like_, options);
    std::vector<NewLayer> layers;
    for (const auto& [name, image] : inputs()) {
      const bool is_aov = name.rfind("aov ", 0) == 0;
      if (!is_aov && name != "result" && name != name_of(Role::Alpha))
        throw Error(ExitCode::Usage,
                    fmt::format("image '{}': a copy of a file takes 'result', 'alpha' and 'aov LAYER'", name));
      layers.push_back({is_aov             ? Role::Color
                        : name == "result" ? Role::Beauty
                                           : Role::Alpha,
                        is_aov ? name.substr(4) : "", read_memory(image)});
    }
    return write_like(in, layers, output_, {keep_noisy_, {"library: write", identity_of_input(in.source), -1}});
  }

  void write_alone() const {
    std::vector<MapChannel> channels;
    const MemoryImage& first = inputs().begin()->second;
    for (const auto& [name, image] : inputs()) {
      if (image.width != first.width || image.height != first.height)
        throw Error(ExitCode::Usage, fmt::format("image '{}': has {} x {} pixels, '{}' has {} x {}", name, image.width,
                                                 image.height, inputs().begin()->first, first.width, first.height));
      static constexpr std::array<const char*, 5> endings{"", "Y", "YA", "RGB", "RGBA"};
      if (static_cast<std::size_t>(image.channels) >= endings.size())
        throw Error(ExitCode::Usage,
                    fmt::format("image '{}': has {} channels, at most 4 are written", name, image.channels));
      const Image samples = read_memory(image);
      for (int c = 0; c < image.channels; ++c)
        channels.push_back({fmt::format("{}.{}", name, endings[static_cast<std::size_t>(image.channels)][c]),
                            crop(samples, samples.bounds(), c, 1)});
    }
    const Rect window{0, 0, first.width, first.height};
    write_maps(output_, channels, window, window);
  }

  std::string output_, like_, view_layer_, view_;
  bool keep_noisy_ = false;
};

/// Merges renders of one frame into a file with variance and halves.
class MergeFilter : public Filter {
 public:
  MergeFilter() {
    add("input", Parameter::of(inputs_));
    add("half B", Parameter::of(half_b_));
    add("output", Parameter::of(output_));
    add("samples", Parameter::of(samples_, 0, Parameter::no_limit, true));
    add("compression", Parameter::of(compression_));
    add("dwa level", Parameter::of(dwa_level_, 0, Parameter::no_limit));
  }

 protected:
  void check_image(const std::string& name) const override { refuse_image(name); }

  Made run(Progress& /*progress*/) override {
    require_path(output_, "output");
    require_exr_output(output_);
    MergeOptions options;
    options.samples = samples_;
    options.half_b = half_b_;
    options.encoding = {compression_from(compression_), dwa_level_};
    if (!options.encoding.compression)
      throw Error(ExitCode::Usage, fmt::format("compression '{}' is none of OpenEXR's", compression_));
    const MergeResult result = merge(inputs_, output_, options);
    Made made;
    made.report = {{"output", output_},         {"files", result.files},   {"samples", result.samples},
                   {"merged", result.merged},   {"joined", result.joined}, {"kept", result.kept},
                   {"dropped", result.dropped}, {"notes", result.notes}};
    return made;
  }

 private:
  std::vector<std::string> inputs_, half_b_;
  std::string output_;
  double samples_ = 0;
  std::string compression_ = "zip";
  double dwa_level_ = default_dwa_level;
};

}  // namespace

std::unique_ptr<Filter> make_read_filter() { return std::make_unique<ReadFilter>(); }
std::unique_ptr<Filter> make_write_filter() { return std::make_unique<WriteFilter>(); }
std::unique_ptr<Filter> make_merge_filter() { return std::make_unique<MergeFilter>(); }

}  // namespace polyrecon
