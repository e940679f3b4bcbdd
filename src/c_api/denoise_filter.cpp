#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "c_api/memory_frame.h"
#include "c_api/output_file.h"
#include "c_api/reading_filter.h"
#include "denoisers/denoisers.h"
#include "pipeline/memory.h"
#include "pipeline/part_of_beauty.h"
#include "pipeline/report_json.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {
namespace {

/// Reconstructs a frame: of images in memory, or of a file.
class DenoiseFilter : public ReadingFilter {
 public:
  DenoiseFilter() {
    add_for_run("output", Parameter::of(output_));
    add("quality", Parameter::of(quality_));
    add("prior", Parameter::of(prior_));
    add("oidn", Parameter::of(oidn_));
    add("oidn device", Parameter::of(oidn_device_));
    add("stages", Parameter::of(stages_, 0, 4));
    add("order", Parameter::of(order_, -1, 4));
    add_for_run("max memory", Parameter::of(max_memory_, 1, Parameter::no_limit));
    add("alpha", Parameter::of(alpha_));
    add("wrap", Parameter::of(wrap_));
    add("keep noisy", Parameter::of(keep_noisy_));
    add_for_run("budget", Parameter::of(map_params_.budget, 0, Parameter::no_limit, true));
    add_for_run("target", Parameter::of(map_params_.target, 0, Parameter::no_limit, true));
    add_for_run("max samples", Parameter::of(map_params_.max_samples, 0, Parameter::no_limit, true));
  }

 protected:
  void check_image(const std::string& name) const override { place_of(name); }

  Made run(Progress& progress) override {
    check_parameters();
    if (!output_.empty()) require_exr_output(output_);
    const Params params = this->params();
    const std::unique_ptr<Denoiser> denoiser = this->denoiser();
    ReadResult in = read(params, denoiser != nullptr);
    refuse_layers_outside_beauty(in);
    Result result = reconstruct(in.frame, {}, params, progress, denoiser.get());
    Made made;
    if (map_params_.budget > 0 || map_params_.target > 0) add_sample_map(result, in, progress, made);
    if (!output_.empty()) {
      const WriteOptions options{keep_noisy_,
                                 {settings(), identity_of_input(in.source), result.error.mean_relative_mse}};
      for (const std::string& note : write_like(in, result_layers(in, result, alpha_), output_, options))
        in.notes.push_back(note);
    }
    made.report = {{"polyrecon", POLYRECON_VERSION}, {"input", input_path()}, {"output", output_}};
    made.report.update(report_json(result.report));
    made.report["notes"] = in.notes;
    for (NamedImage& image : result_images(in.frame, std::move(result), alpha_))
      made.images.push_back(std::move(image));
    return made;
  }

 private:
  void check_parameters() const {
    if (!input_path().empty() && !inputs().empty())
      throw Error(ExitCode::Usage, "there are images and 'input': take one of them away");
    if (!output_.empty() && input_path().empty())
      throw Error(ExitCode::Usage,
                  "'output' is a copy of the file 'input' with new layers; images in memory are written by the filter "
                  "'write'");
    if (input_path().empty() && chooses_layers())
      throw Error(ExitCode::Usage, "'map', 'aov', 'view layer' and 'view' choose layers of the file 'input'");
    quality();
    if (map_params_.budget > 0 || map_params_.target > 0) validate(map_params_);
    if (prior_.empty() && !(oidn_.empty() && oidn_device_.empty()))
      throw Error(ExitCode::Usage, "'oidn' and 'oidn device' need the prior 'oidn'");
  }

  Quality quality() const {
    std::vector<std::string> names;
    for (const NamedQuality& named : qualities) {
      if (quality_ == named.name) return named.quality;
      names.emplace_back(named.name);
    }
    throw Error(ExitCode::Usage, fmt::format("quality '{}' is none of: {}", quality_, fmt::join(names, ", ")));
  }

  Params params() const {
    Params params = params_for(quality());
    if (stages_ > 0) params.stages = static_cast<int>(stages_);
    if (order_ >= 0) params.max_order = static_cast<int>(order_);
    params.max_memory = static_cast<std::size_t>(max_memory_);
    params.reconstruct_alpha = alpha_;
    validate(params);
    return params;
  }

  /// The denoiser that makes the prior; null without one.
  std::unique_ptr<Denoiser> denoiser() const {
    if (prior_.empty()) return nullptr;
    const auto found = denoisers().find(prior_);
    if (found == denoisers().end())
      throw Error(ExitCode::Usage,
                  fmt::format("no denoiser '{}'; a picture of another one is the image 'prior'", prior_));
    if (inputs().count(name_of(Role::Prior)) > 0)
      throw Error(ExitCode::Usage, fmt::format("'{}' makes the prior itself: take the image 'prior' away", prior_));
    DenoiserOptions options;
    options.oidn.path = oidn_;
    if (!oidn_device_.empty()) {
      const auto devices = oidn_devices();
      if (std::find(devices.begin(), devices.end(), oidn_device_) == devices.end())
        throw Error(ExitCode::Usage,
                    fmt::format("oidn device '{}' is none of: {}", oidn_device_, fmt::join(devices, ", ")));
      options.oidn.device = oidn_device_;
    }
    return found->second(options);
  }

  ReadResult read(const Params& params, bool runs_denoiser) const {
    ReadResult in;
    if (input_path().empty()) {
      in.frame = frame_from_memory(inputs(), read_options().samples, in.notes);
      in.frame.wraps = wrap_;
      return in;
    }
    ReadOptions options = read_options();
    if (wrap_) options.wrap = Wrap::X;
    options.accept = [&](const std::string& path, FrameShape shape) {
      if (runs_denoiser) add_denoiser(shape);
      require_memory(path, shape, params);
    };
    in = read_frame(input_path(), options);
    if (in.source.pictures.size() > 1)
      in.notes.push_back(fmt::format("{}: only {} is denoised; the other {} pictures of the file stay noisy",
                                     input_path(), name_of(LayerView{in.source.view_layer, in.source.view}),
                                     in.source.pictures.size() - 1));
    return in;
  }

  static void refuse_layers_outside_beauty(const ReadResult& in) {
    std::vector<std::string> layers = layers_outside_beauty(in.frame);
    layers.insert(layers.end(), in.outside_beauty.begin(), in.outside_beauty.end());
    if (!layers.empty())
      throw Error(ExitCode::BadInput,
                  fmt::format("layer '{}' is no part of the beauty: denoise it as the beauty of a filter of its own",
                              layers.front()));
  }

  void add_sample_map(const Result& result, const ReadResult& in, Progress& progress, Made& made) const {
    SampleMap map = make_sample_map(result.error, in.frame.sample_count, {}, map_params_, progress);
    made.images.push_back({"samples", std::move(map.samples)});
    made.images.push_back({"importance", std::move(map.importance)});
  }

  /// The new layers of a copy of the input.
  static std::vector<NewLayer> result_layers(const ReadResult& in, const Result& result, bool with_alpha) {
    std::vector<NewLayer> layers{{Role::Beauty, {}, result.beauty}};
    for (std::size_t i = 0; i < result.aovs.size(); ++i)
      layers.push_back({Role::Color, in.frame.aovs[i].name, result.aovs[i]});
    if (with_alpha && !result.alpha.empty()) layers.push_back({Role::Alpha, {}, result.alpha});
    return layers;
  }

  std::string output_, quality_ = "standard", prior_, oidn_, oidn_device_;
  double stages_ = 0, order_ = -1;
  double max_memory_ = static_cast<double>(Params().max_memory);
  bool alpha_ = false, wrap_ = false, keep_noisy_ = false;
  SampleMapParams map_params_;
};

}  // namespace

std::unique_ptr<Filter> make_denoise_filter() { return std::make_unique<DenoiseFilter>(); }

}  // namespace polyrecon
