#include "c_api/memory_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/repair.h"
#include "io/layers/channel_groups.h"
#include "io/renderers/known_names.h"
#include "io/values/accept_pass.h"
#include "io/values/beyond_range.h"
#include "io/values/pass_values.h"
#include "polyrecon/error.h"
#include "polyrecon/roles.h"

namespace polyrecon {
namespace {

using Part = ImagePlace::Part;

constexpr const char* aov_prefix = "aov ";

struct PartName {
  Part part;
  const char* suffix;
  Image Pass::*image;
};
constexpr std::array<PartName, 4> parts{{{Part::Mean, "", &Pass::mean},
                                         {Part::Variance, " variance", &Pass::variance},
                                         {Part::HalfA, " A", &Pass::half_a},
                                         {Part::HalfB, " B", &Pass::half_b}}};

/// Whether a frame in memory can have images of this role, other than further layers.
bool is_taken(const RoleInfo& info) { return info.chosen && !info.on_request; }

bool has_noise(Role role) { return info_of(role).feature || info_of(role).values == Values::Radiance; }

[[noreturn]] void refuse_name(const std::string& name) {
  throw Error(ExitCode::Usage, fmt::format("no image '{}'; there are: {}, and 'aov NAME' for further layers", name,
                                           fmt::join(frame_image_names(), ", ")));
}

/// Brings +Inf and the sky into range, as beyond_range says for layers of files.
void bring_into_range(const std::string& name, const ImagePlace& place, bool is_half_float, Image& image,
                      std::vector<std::string>& notes) {
  if (place.part == Part::Variance) return;
  const RoleInfo& info = info_of(place.role);
  std::size_t lone = 0, overflows = 0;
  for (int c = 0; c < image.channels(); ++c) {
    if (info.empty == EmptyValue::ZeroOrSky) bring_into_range(BeyondRange::Sky, image.plane(c), image.pixels());
    if (info.values != Values::Radiance || !is_half_float) continue;
    lone += drop_lone_overflows(image.plane(c), image.width(), image.height());
    overflows += bring_into_range(BeyondRange::LargestHalf, image.plane(c), image.pixels());
  }
  if (lone > 0) notes.push_back(lone_overflow_note(name, lone));
  if (overflows > 0) notes.push_back(overflow_note(name, overflows));
}

/// Fills a frame image by image.
class FrameMaker {
 public:
  explicit FrameMaker(std::vector<std::string>& notes) : notes_(notes) {}

  void add(const std::string& name, const MemoryImage& from) {
    const ImagePlace place = place_of(name);
    const RoleInfo& info = info_of(place.role);
    if (!info.layer_channels.allow(static_cast<std::size_t>(from.channels)))
      throw Error(ExitCode::Usage,
                  fmt::format("image '{}': has {} channels, {} are needed", name, from.channels, info.channels));
    Image image = read_memory(from);
    bring_into_range(name, place, from.format == POLYRECON_HALF, image, notes_);
    image = with_channels(std::move(image), info.channels, place.part == Part::Variance);
    if (place.role == Role::Alpha)
      frame_.alpha = std::move(image);
    else if (place.role == Role::SampleCount)
      frame_.sample_count = std::move(image);
    else
      pass(place).*image_of(place.part) = std::move(image);
  }

  Frame finish(double samples) {
    if (frame_.beauty.mean.empty()) throw Error(ExitCode::Usage, "there is no image 'beauty'");
    check_pass("beauty", frame_.beauty);
    for (Feature& feature : frame_.features) check_pass(name_of(feature.role), feature.pass);
    for (Pass& aov : frame_.aovs) check_pass(aov_prefix + aov.name, aov);
    if (!frame_.prior.mean.empty() || frame_.prior.noise_is_known()) check_pass(name_of(Role::Prior), frame_.prior);
    for (const auto& [name, image] : {std::pair<const char*, Image*>{name_of(Role::Alpha), &frame_.alpha},
                                      {name_of(Role::SampleCount), &frame_.sample_count}})
      if (!image->empty()) check_size(name, *image);
    std::sort(frame_.features.begin(), frame_.features.end(),
              [](const Feature& a, const Feature& b) { return a.role < b.role; });
    take_counts(samples);
    frame_.data_window = frame_.beauty.mean.bounds();
    frame_.sky_depth = sky_depth();
    return std::move(frame_);
  }

 private:
  static Image Pass::*image_of(Part part) {
    return std::find_if(parts.begin(), parts.end(), [&](const PartName& p) { return p.part == part; })->image;
  }

  Pass& pass(const ImagePlace& place) {
    if (place.role == Role::Beauty) return named(frame_.beauty, name_of(Role::Beauty));
    if (place.role == Role::Prior) return named(frame_.prior, name_of(Role::Prior));
    if (place.role == Role::Color) {
      for (Pass& aov : frame_.aovs)
        if (aov.name == place.aov) return aov;
      return named(frame_.aovs.emplace_back(), place.aov);
    }
    for (Feature& feature : frame_.features)
      if (feature.role == place.role) return feature.pass;
    frame_.features.push_back({place.role, {}});
    return named(frame_.features.back().pass, name_of(place.role));
  }

  static Pass& named(Pass& pass, const std::string& name) {
    pass.name = name;
    return pass;
  }

  void check_size(const std::string& name, const Image& image) const {
    const Image& beauty = frame_.beauty.mean;
    if (image.width() != beauty.width() || image.height() != beauty.height())
      throw Error(ExitCode::Usage, fmt::format("image '{}': has {} x {} pixels, the beauty has {} x {}", name,
                                               image.width(), image.height(), beauty.width(), beauty.height()));
  }

  void check_pass(const std::string& name, Pass& pass) {
    if (pass.mean.empty())
      throw Error(ExitCode::Usage, fmt::format("there is a variance or half of '{}', but no image '{}'", name, name));
    if (pass.half_a.empty() != pass.half_b.empty())
      throw Error(ExitCode::Usage, fmt::format("there is one of '{} A' and '{} B': give both, or none", name, name));
    for (const PartName& part : parts)
      if (const Image& image = pass.*part.image; !image.empty()) check_size(name + part.suffix, image);
    const auto quoted = [&](const char* suffix) { return fmt::format("'{}{}'", name, suffix); };
    const PassNames names{quoted(""), quoted(" variance"), quoted(" A"), quoted(" B")};
    note(check_halves(pass, names, "give the halves of this image"));
    note(check_variance(pass.variance, pass.mean, names));
    if (&pass == &frame_.beauty)
      note(note_on_large_variance(pass, names, "it must be that of the mean of all samples, not of one sample"));
  }

  void note(const std::string& text) {
    if (!text.empty()) notes_.push_back(text);
  }

  void take_counts(double samples) {
    Image& counts = frame_.sample_count;
    if (counts.empty()) {
      if (samples > 0) counts = Image(frame_.width(), frame_.height(), 1, static_cast<Real>(samples));
      return;
    }
    const std::size_t repaired = repair_counts(counts);
    if (repaired == counts.pixels()) {
      counts = {};
      notes_.emplace_back("'sample-count' is not used: no pixel has a sample count");
    } else if (repaired > 0) {
      notes_.push_back(
          fmt::format("'sample-count': {} pixels without a usable sample count get the mean of the others", repaired));
    }
  }

  Frame frame_;
  std::vector<std::string>& notes_;
};

}  // namespace

ImagePlace place_of(const std::string& name) {
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    if (!ends_with(name, part->suffix)) continue;
    const std::string stem = name.substr(0, name.size() - std::string(part->suffix).size());
    if (stem.rfind(aov_prefix, 0) == 0 && stem != aov_prefix)
      return {Role::Color, stem.substr(std::string(aov_prefix).size()), part->part};
    const auto role = role_from(stem);
    if (!role || !is_taken(info_of(*role)) || (part->part != Part::Mean && !has_noise(*role))) refuse_name(name);
    return {*role, {}, part->part};
  }
  refuse_name(name);
}

std::vector<std::string> frame_image_names() {
  std::vector<std::string> names;
  for (const RoleInfo& info : role_table())
    if (is_taken(info))
      for (const PartName& part : parts)
        if (part.part == Part::Mean || has_noise(info.role)) names.push_back(std::string(info.name) + part.suffix);
  return names;
}

std::vector<NamedImage> named_images(const Frame& frame) {
  std::vector<NamedImage> images;
  const auto add = [&](const std::string& name, const Image& image) {
    if (!image.empty()) images.push_back({name, image});
  };
  const auto add_pass = [&](const std::string& name, const Pass& pass) {
    for (const PartName& part : parts) add(name + part.suffix, pass.*part.image);
  };
  add_pass(name_of(Role::Beauty), frame.beauty);
  for (const Feature& feature : frame.features) add_pass(name_of(feature.role), feature.pass);
  add_pass(name_of(Role::Prior), frame.prior);
  add(name_of(Role::SampleCount), frame.sample_count);
  add(name_of(Role::Alpha), frame.alpha);
  for (const Pass& aov : frame.aovs) add_pass(aov_prefix + aov.name, aov);
  return images;
}

Frame frame_from_memory(const std::map<std::string, MemoryImage>& images, double samples,
                        std::vector<std::string>& notes) {
  FrameMaker maker(notes);
  for (const auto& [name, image] : images) maker.add(name, image);
  return maker.finish(samples);
}

}  // namespace polyrecon
