#include <fmt/format.h>

#include <utility>

#include "c_api/filter.h"
#include "c_api/output_file.h"
#include "io/values/pass_values.h"
#include "maps/error_map_images.h"
#include "polyrecon/roles.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {
namespace {

constexpr const char* cost_name = "cost";

/// Distributes extra samples by an error map.
class SampleMapFilter : public Filter {
 public:
  SampleMapFilter() {
    add("budget", Parameter::of(params_.budget, 0, Parameter::no_limit, true));
    add("target", Parameter::of(params_.target, 0, Parameter::no_limit, true));
    add("max samples", Parameter::of(params_.max_samples, 0, Parameter::no_limit, true));
    add("samples", Parameter::of(samples_, 0, Parameter::no_limit, true));
  }

 protected:
  void check_image(const std::string& name) const override {
    if (name == cost_name || name == name_of(Role::SampleCount)) return;
    for (const ErrorMapImage& entry : error_map_images)
      if (name == error_image_name(entry)) return;
    throw Error(ExitCode::Usage,
                fmt::format("no image '{}'; there are the images of an error map, 'sample-count' and 'cost'", name));
  }

  Made run(Progress& progress) override {
    validate(params_);
    ErrorMap error;
    for (const ErrorMapImage& entry : error_map_images) {
      const std::string name = error_image_name(entry);
      Image image = input(name);
      if (image.empty() && !entry.may_be_missing && entry.image != &ErrorMap::mse)
        throw Error(ExitCode::Usage, fmt::format("there is no image '{}'", name));
      require_channels(name, image, static_cast<int>(entry.channels()));
      error.*entry.image = std::move(image);
    }
    Image counts = input(name_of(Role::SampleCount));
    require_channels(name_of(Role::SampleCount), counts, 1);
    if (!counts.empty() && repair_counts(counts) == counts.pixels()) counts = {};
    if (counts.empty() && samples_ > 0)
      counts = Image(error.relative_mse.width(), error.relative_mse.height(), 1, static_cast<Real>(samples_));
    const Image cost = input(cost_name);
    require_channels(cost_name, cost, 1);
    SampleMap map = make_sample_map(error, counts, cost, params_, progress);
    Made made;
    made.report = {{"min", map.min},
                   {"max", map.max},
                   {"total", map.total},
                   {"error_before", map.error_before},
                   {"error_after", map.error_after},
                   {"unknown_pixels", map.unknown_pixels},
                   {"limit_met", map.limit_met}};
    made.images.push_back({"samples", std::move(map.samples)});
    made.images.push_back({"importance", std::move(map.importance)});
    return made;
  }

 private:
  static void require_channels(const std::string& name, const Image& image, int channels) {
    if (!image.empty() && image.channels() != channels)
      throw Error(ExitCode::Usage,
                  fmt::format("image '{}': has {} channels, {} are needed", name, image.channels(), channels));
  }

  SampleMapParams params_;
  double samples_ = 0;
};

}  // namespace

std::unique_ptr<Filter> make_sample_map_filter() { return std::make_unique<SampleMapFilter>(); }

}  // namespace polyrecon
