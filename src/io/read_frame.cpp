#include "polyrecon/read_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/frame_shape.h"
#include "core/rect.h"
#include "core/repair.h"
#include "io/layers/channel_names.h"
#include "io/layers/choose_layers.h"
#include "io/observed_read.h"
#include "io/part_reader.h"
#include "io/renderers/known_names.h"
#include "io/values/accept_pass.h"
#include "io/values/beyond_range.h"
#include "io/values/pass_values.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The contents of a variance layer: by its name, unless the user says so.
Companion kind_of(const Layer& layer, VarianceKind by_user) {
  switch (by_user) {
    case VarianceKind::Mean:
      return Companion::VarianceOfMean;
    case VarianceKind::Sample:
      return Companion::VarianceOfSample;
    case VarianceKind::SecondMoment:
      return layer.companion == Companion::SecondMomentOfXyz ? layer.companion : Companion::SecondMoment;
    case VarianceKind::Auto:
      break;
  }
  return layer.companion;
}

Image times(Image image, const std::array<Real, 4>& factors) {
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i) image.plane(c)[i] *= factors[static_cast<std::size_t>(c)];
  return image;
}

/// A pass with the images that are read for it; nullptr without one.
struct WantedPass {
  PassChoice choice;
  Image *mean = nullptr, *variance = nullptr, *half_a = nullptr, *half_b = nullptr;
};

constexpr double most_overflows = 0.01;  // share of a variance's samples whose value half floats may have lost

/// Makes a frame of the chosen layers.
class FrameBuilder {
 public:
  FrameBuilder(LayerChoice choice, const ReadOptions& options)
      : options_(options), passes_(std::move(choice.passes)), reader_(result_.source, options.limits) {
    result_.source = std::move(choice.source);
    result_.outside_beauty = std::move(choice.outside_beauty);
    result_.notes = std::move(choice.notes);
  }

  ReadResult build(const BandObserver& observer) {
    choose_window();
    result_.frame.wraps = wraps();
    want_images();
    if (options_.accept) options_.accept(result_.source.path, shape());
    reader_.read(observer);
    result_.frame.data_window = window_;
    result_.frame.sky_depth = sky_depth();
    take_sample_counts();
    for (WantedPass& pass : wanted_) place(pass);
    if (alpha_) result_.frame.alpha = std::move(*alpha_);
    return std::move(result_);
  }

 private:
  const Layer& layer(int index) const { return result_.source.layers[static_cast<std::size_t>(index)]; }

  /// The frame is the beauty's, whatever boxes the parts of other passes are cut to.
  void choose_window() {
    window_ = reader_.window_of(layer(passes_.front().mean));
    reader_.cover(window_);
  }

  /// Whether the frame is a whole panorama. With margins beyond the picture, or without some columns, it has no seam.
  bool wraps() {
    if (options_.wrap == Wrap::None) return false;
    const Layer& beauty = layer(passes_.front().mean);
    const PartInfo& part =
        result_.source.files[static_cast<std::size_t>(beauty.file)].parts[static_cast<std::size_t>(beauty.part)];
    const AttributeInfo* map = find_attribute(part, "envmap");
    if (options_.wrap == Wrap::Auto && !(map && map->value == "latlong")) return false;
    const bool whole = window_.x0 == part.display_window.x0 && window_.x1 == part.display_window.x1;
    if (!whole)
      result_.notes.push_back(fmt::format(
          "{}: columns do not wrap around: the data window is not as wide as the picture", result_.source.path));
    else if (options_.wrap == Wrap::Auto)
      result_.notes.emplace_back("a panorama (envmap latlong): columns wrap around; --wrap none if they should not");
    return whole;
  }

  void want_images() {
    const auto image = [&](int index) {
      return index < 0 ? nullptr : reader_.want(layer(index), layer(index).channels);
    };
    for (const PassChoice& p : passes_)
      wanted_.push_back({p, image(p.mean), image(p.variance), image(p.half_a), image(p.half_b)});
    for (const PassChoice& p : passes_)
      if ((p.role == Role::Beauty || p.role == Role::Prior) && layer(p.mean).name == result_.source.alpha_layer)
        alpha_ = reader_.want(layer(p.mean), {layer(p.mean).alpha});
  }

  FrameShape shape() const {
    FrameShape shape{window_.area(), static_cast<int>(reader_.samples() / window_.area())};
    shape.wrapped_rows = result_.frame.wraps ? window_.height() : 0;
    for (const PassChoice& pass : passes_) add_pass(shape, pass.role, {pass.variance >= 0, pass.half_a >= 0});
    return shape;
  }

  /// The image on the frame's window; empty without one.
  Image take(Image* image, Role role, int index, int channels, bool is_variance = false) {
    if (!image) return {};
    bring_channels_into_range(*image, role, layer(index));
    return with_channels(std::move(*image), channels, is_variance);
  }

  void bring_channels_into_range(Image& image, Role role, const Layer& from) {
    std::size_t lone = 0, overflows = 0;
    for (int c = 0; c < image.channels(); ++c) {
      const BeyondRange beyond =
          beyond_range(reader_.part_of(from), from, role, from.channels[static_cast<std::size_t>(c)]);
      if (beyond == BeyondRange::LargestHalf)
        lone += drop_lone_overflows(image.plane(c), image.width(), image.height());
      overflows += bring_into_range(beyond, image.plane(c), image.pixels());
    }
    if (lone > 0) result_.notes.push_back(lone_overflow_note(from.name, lone));
    if (overflows > 0) result_.notes.push_back(overflow_note(from.name, overflows));
    if (from.companion == Companion::Mean && info_of(role).values == Values::Radiance) note_too_bright(image, from);
  }

  void note_too_bright(const Image& image, const Layer& from) {
    std::size_t samples = 0;
    for (int c = 0; c < image.channels(); ++c)
      samples += static_cast<std::size_t>(std::count_if(image.plane(c), image.plane(c) + image.pixels(),
                                                        [](Real v) { return std::isfinite(v) && !usable(v); }));
    if (samples > 0)
      result_.notes.push_back(
          fmt::format("{}: {} samples beyond {:g} count as not finite; render with a lower exposure "
                      "to keep them",
                      from.name, samples, static_cast<double>(largest_value)));
  }

  /// The counts of a sample-count layer; empty, with a note, where it holds fractions of an unknown number.
  Image take_counts(WantedPass& wanted) {
    const Layer& from = layer(wanted.choice.mean);
    Image counts = take(wanted.mean, Role::SampleCount, wanted.choice.mean, 1);
    if (!to_sample_counts(counts, from.pass, counts_.everywhere)) {
      result_.notes.push_back(
          fmt::format("{} is not used: it holds fractions of an unknown sample count; give --samples", from.name));
      return {};
    }
    const std::size_t repaired = repair_counts(counts);
    if (repaired == counts.pixels()) {
      result_.notes.push_back(fmt::format("{} is not used: no pixel has a sample count; give --samples", from.name));
      return {};
    }
    if (repaired > 0)
      result_.notes.push_back(
          fmt::format("{}: {} pixels without a usable sample count get the mean of the others", from.name, repaired));
    return counts;
  }

  /// Finds the samples per pixel, which variances need: of the sample-count layer, else by --samples or the metadata.
  void take_sample_counts() {
    const auto metadata = samples_in_metadata(result_.source.files.front(), result_.source.view_layer);
    counts_.everywhere = options_.samples > 0 ? options_.samples : metadata.value_or(0);
    for (WantedPass& pass : wanted_)
      if (pass.choice.role == Role::SampleCount) result_.frame.sample_count = take_counts(pass);
    Image& counts = result_.frame.sample_count;
    if (counts.empty() && counts_.everywhere > 0)
      counts = Image(window_.width(), window_.height(), 1, static_cast<Real>(counts_.everywhere));
    if (!counts.empty()) counts_.per_pixel = &counts;
  }

  /// The variance of the mean; empty, with a note, where it needs a sample count that is unknown.
  Image take_variance(WantedPass& wanted, const Image& mean) {
    if (!wanted.variance) return {};
    const Layer& from = layer(wanted.choice.variance);
    const Companion kind = kind_of(from, options_.variance_kind);
    const std::size_t beyond = half_overflows(reader_.part_of(from), from, *wanted.variance);
    const auto samples = static_cast<double>(wanted.variance->pixels() * from.channels.size());
    if (static_cast<double>(beyond) > most_overflows * samples) {
      result_.notes.push_back(
          fmt::format("{} is not used: {} of its half-float samples are +Inf, beyond the largest half {}; save it as "
                      "32-bit float",
                      from.name, beyond, largest_half));
      return {};
    }
    Image variance = take(wanted.variance, wanted.choice.role, wanted.choice.variance, mean.channels(),
                          kind != Companion::SecondMoment);
    if (kind != Companion::VarianceOfMean && !counts_.known()) {
      result_.notes.push_back(fmt::format(
          "{} is not used: it is the {} and the sample count is unknown; give --samples", from.name, name_of(kind)));
      return {};
    }
    to_variance_of_mean(variance, kind, mean, counts_);
    note(check_variance(variance, mean, names_of(wanted.choice)));
    return variance;
  }

  /// The names of a pass's images in notes: those of the layers.
  PassNames names_of(const PassChoice& choice) const {
    const auto name = [&](int index) { return index < 0 ? std::string() : layer(index).name; };
    return {name(choice.mean), name(choice.variance), name(choice.half_a), name(choice.half_b)};
  }

  void note(const std::string& text) {
    if (!text.empty()) result_.notes.push_back(text);
  }

  Pass take_pass(WantedPass& wanted) {
    const Role role = wanted.choice.role;
    const int channels = info_of(role).channels;
    Pass pass;
    pass.name = layer(wanted.choice.mean).name;
    pass.mean = take(wanted.mean, role, wanted.choice.mean, channels);
    pass.variance = take_variance(wanted, pass.mean);
    const PassNames names = names_of(wanted.choice);
    if (role == Role::Beauty)
      note(note_on_large_variance(pass, names, "--variance-kind sample if it is that of one sample"));
    pass.half_a = take(wanted.half_a, role, wanted.choice.half_a, channels);
    pass.half_b = take(wanted.half_b, role, wanted.choice.half_b, channels);
    note(check_halves(pass, names, "if they are halves of another layer, name it with --map"));
    return pass;
  }

  void place(WantedPass& wanted) {
    Frame& frame = result_.frame;
    const RoleInfo& info = info_of(wanted.choice.role);
    if (info.feature) {
      frame.features.push_back({info.role, take_pass(wanted)});
      return;
    }
    switch (info.role) {
      case Role::Beauty:
        frame.beauty = take_pass(wanted);
        break;
      case Role::Prior:
        frame.prior = take_pass(wanted);
        break;
      case Role::Color:
        frame.aovs.push_back(take_pass(wanted));
        break;
      case Role::Alpha:
        if (!alpha_) frame.alpha = take(wanted.mean, info.role, wanted.choice.mean, info.channels);
        break;
      case Role::Motion:
        frame.motion = times(take(wanted.mean, info.role, wanted.choice.mean, info.channels),
                             motion_factors(layer(wanted.choice.mean).pass));
        break;
      default:  // sample counts, which are taken first; features are above, and other roles are never chosen
        break;
    }
  }

  const ReadOptions& options_;
  std::vector<PassChoice> passes_;
  ReadResult result_;
  PartReader reader_;
  std::vector<WantedPass> wanted_;
  Rect window_;
  Image* alpha_ = nullptr;
  SampleCounts counts_;
};

}  // namespace

ReadResult read_frame(const std::string& path, const ReadOptions& options) { return read_frame(path, options, {}); }

ReadResult read_frame(const std::string& path, const ReadOptions& options, const BandObserver& observer) {
  return FrameBuilder(choose_layers(path, options), options).build(observer);
}

ReadResult read_frame_header(const std::string& path, const ReadOptions& options) {
  LayerChoice choice = choose_layers(path, options);
  ReadResult result;
  result.source = std::move(choice.source);
  result.notes = std::move(choice.notes);
  return result;
}

}  // namespace polyrecon
