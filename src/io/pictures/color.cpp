#include "io/pictures/color.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace ocio = OCIO_NAMESPACE;

// The views are made of OpenColorIO's own transforms, so that the same text works in any other program. Filmic: log2
// from -12.47 to +4.03 stops about middle grey 0.18 (which is 10 / 16.5 = 0.606 of the scale) goes to sRGB's 0.46, with
// a toe and a shoulder.
constexpr const char* built_in_config = R"(ocio_profile_version: 2
roles:
  default: Linear Rec.709
  scene_linear: Linear Rec.709
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  sRGB:
    - !<View> {name: Standard, colorspace: sRGB}
    - !<View> {name: Filmic, colorspace: Filmic sRGB}
active_displays: [sRGB]
active_views: [Standard, Filmic]
colorspaces:
  - !<ColorSpace>
    name: Linear Rec.709
    encoding: scene-linear
  - !<ColorSpace>
    name: sRGB
    encoding: sdr-video
    from_scene_reference: !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}
  - !<ColorSpace>
    name: Filmic sRGB
    encoding: sdr-video
    from_scene_reference: !<GroupTransform>
      children:
        - !<AllocationTransform> {allocation: lg2, vars: [-12.473931188, 4.026068812]}
        - !<GradingRGBCurveTransform>
          style: log
          master: {control_points: [0, 0, 0.25, 0.03, 0.45, 0.19, 0.606, 0.46, 0.75, 0.75, 0.88, 0.93, 1, 1]}
)";

bool has_config() {
  const char* path = std::getenv("OCIO");
  return path && *path;
}

ocio::ConstConfigRcPtr current_config() {
  if (has_config()) return ocio::Config::CreateFromEnv();
  std::istringstream text(built_in_config);
  return ocio::Config::CreateFromStream(text);
}

/// The requested view, or the default one.
std::string view_of(const ocio::Config& config, const std::string& display, const std::string& wanted) {
  if (wanted.empty()) return config.getDefaultView(display.c_str());
  std::string known;
  for (int i = 0; i < config.getNumViews(display.c_str()); ++i) {
    std::string view = config.getView(display.c_str(), i);
    if (view == wanted) return view;
    known += (i ? ", " : "") + view;
  }
  throw Error(ExitCode::Usage, "no view '" + wanted + "' on the display " + display + ": it has " + known);
}

ocio::ConstCPUProcessorRcPtr processor(const DisplayParams& params) {
  const ocio::ConstConfigRcPtr config = current_config();
  const std::string display = config->getDefaultDisplay();
  const std::string view = view_of(*config, display, params.view);
  const char* source = config->hasRole(ocio::ROLE_SCENE_LINEAR) ? ocio::ROLE_SCENE_LINEAR : ocio::ROLE_DEFAULT;
  return config->getProcessor(source, display.c_str(), view.c_str(), ocio::TRANSFORM_DIR_FORWARD)
      ->getDefaultCPUProcessor();
}

}  // namespace

Image to_display(const Image& linear, const DisplayParams& params) {
  constexpr std::array<Real, 3> magenta{1, 0, 1};
  const auto scale = static_cast<float>(std::exp2(params.exposure));
  Image out(linear.width(), linear.height(), 3);
  std::vector<float> row(3 * static_cast<std::size_t>(linear.width()));
  try {
    const ocio::ConstCPUProcessorRcPtr transform = processor(params);
    for (int y = 0; y < linear.height(); ++y) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = static_cast<float>(linear.row(static_cast<int>(i % 3), y)[i / 3]) * scale;
      ocio::PackedImageDesc image(row.data(), linear.width(), 1, 3);
      transform->apply(image);
      for (int x = 0; x < linear.width(); ++x) {
        bool finite = true;
        for (int c = 0; c < 3; ++c) finite = finite && std::isfinite(linear.at(x, y, c));
        for (int c = 0; c < 3; ++c) {
          const Real value = row[static_cast<std::size_t>(3 * x + c)];
          out.at(x, y, c) = finite ? std::clamp(value, Real{0}, Real{1}) : magenta[static_cast<std::size_t>(c)];
        }
      }
    }
  } catch (const ocio::Exception& e) {
    throw Error(ExitCode::BadInput, std::string("OpenColorIO (check $OCIO): ") + e.what());
  }
  return out;
}

DisplayViews display_views(const std::string& wanted) {
  try {
    const ocio::ConstConfigRcPtr config = current_config();
    const std::string display = config->getDefaultDisplay();
    DisplayViews views;
    for (int i = 0; i < config->getNumViews(display.c_str()); ++i)
      views.names.emplace_back(config->getView(display.c_str(), i));
    views.chosen = view_of(*config, display, wanted);
    if (!has_config()) views.plain_srgb = "Standard";
    return views;
  } catch (const ocio::Exception& e) {
    throw Error(ExitCode::BadInput, std::string("OpenColorIO (check $OCIO): ") + e.what());
  }
}

DisplayTable display_table(const std::string& view) {
  // From 0 to 2^10 in steps of less than half a stop: between them a curve for displays is as good as straight.
  constexpr int size = 48;
  constexpr double scale = 4096;
  DisplayTable table{size, scale, std::log2(1024 * scale + 1), Image(size * size, size, 3)};
  const auto level = [&](int i) { return static_cast<Real>((std::exp2(table.length * i / (size - 1)) - 1) / scale); };
  for (int blue = 0; blue < size; ++blue)
    for (int green = 0; green < size; ++green)
      for (int red = 0; red < size; ++red) {
        const int x = green * size + red;
        table.colors.at(x, blue, 0) = level(red);
        table.colors.at(x, blue, 1) = level(green);
        table.colors.at(x, blue, 2) = level(blue);
      }
  table.colors = to_display(table.colors, {0, view});
  return table;
}

LogRange log_range(const Image& values) {
  std::vector<Real> positive;
  for (std::size_t i = 0; i < values.pixels(); ++i)
    if (const Real v = values.plane(0)[i]; std::isfinite(v) && v > 0) positive.push_back(v);
  if (positive.empty()) return {};
  const auto percentile = [&](double p) {
    const auto at = positive.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(positive.size() - 1));
    std::nth_element(positive.begin(), at, positive.end());
    return static_cast<double>(*at);
  };
  const double high = percentile(0.999);
  return {std::max(percentile(0.01), high * 1e-4), high};
}

}  // namespace polyrecon
