#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "denoisers/denoisers.h"
#include "denoisers/oidn_library.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Open Image Denoise (Intel; Áfra 2019-2026), a network that was trained on renders.
class Oidn final : public Denoiser {
 public:
  explicit Oidn(const OidnOptions& options) : library_(options) {}

  std::string name() const override {
    return fmt::format("Open Image Denoise {} ({})", library_.version(), library_.device());
  }
  std::string place() const override { return library_.path(); }

  DenoiserFeatures prefilter(DenoiserFeatures noisy, std::size_t max_bytes, Progress& progress) const override {
    const double share = noisy.albedo.empty() || noisy.normal.empty() ? 1 : 0.5;
    if (!noisy.albedo.empty()) noisy.albedo = run({nullptr, &noisy.albedo, nullptr}, share, max_bytes, progress);
    if (!noisy.normal.empty()) noisy.normal = run({nullptr, nullptr, &noisy.normal}, share, max_bytes, progress);
    return noisy;
  }

  Image denoise(const Image& noisy, const DenoiserFeatures& features, std::size_t max_bytes,
                Progress& progress) const override {
    OidnImages images{&noisy, nullptr, nullptr};
    if (!features.albedo.empty()) images.albedo = &features.albedo;
    if (images.albedo && !features.normal.empty()) images.normal = &features.normal;  // none without an albedo
    return run(images, 1, max_bytes, progress);
  }

 private:
  /// share: of the units of a call.
  Image run(const OidnImages& images, double share, std::size_t max_bytes, Progress& progress) const {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    const std::size_t copies = images.shape().pixels() * denoiser_run_channels * sizeof(float);
    double owed = 0;
    return library_.filter(images, max_bytes - std::min(max_bytes, copies), [&](double part) {
      owed += part * share * static_cast<double>(units);
      const auto whole = static_cast<std::size_t>(owed);
      owed -= static_cast<double>(whole);
      if (whole > 0) progress.advance(whole);
      return !progress.cancelled();
    });
  }

  OidnLibrary library_;
};

}  // namespace

std::unique_ptr<Denoiser> make_oidn(const DenoiserOptions& options) { return std::make_unique<Oidn>(options.oidn); }

}  // namespace polyrecon
