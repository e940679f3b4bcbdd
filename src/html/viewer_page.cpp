#include "html/viewer_page.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "core/relmse.h"
#include "core/utf8.h"
#include "html/escaped.h"
#include "html/packed_samples.h"
#include "html/viewer_text.h"
#include "io/pictures/false_color.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

/// Text as people may see it: what is no character, or would act on the page's text, is U+FFFD.
std::string readable(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    point.valid && !is_control(point.code) ? out.append(text, at, point.bytes) : out.append("\xef\xbf\xbd");
    at += point.bytes;
  }
  return out;
}

Json readable(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(readable(text));
  return out;
}

/// JSON inside of an element: no "<" could end it.
std::string embedded(const Json& value) {
  std::string out;
  for (const char c : value.dump()) c == '<' ? out.append("\\u003c") : out.append(1, c);
  return out;
}

/// 256 colours of a map, three bytes each, in base64.
std::string ramp(Image (*color)(const Image&)) {
  Image values(256, 1, 1);
  for (int i = 0; i < 256; ++i) values.at(i, 0, 0) = static_cast<Real>(i) / 255;
  const Image colors = color(values);
  std::string bytes;
  for (int i = 0; i < 256; ++i)
    for (int c = 0; c < 3; ++c) bytes += static_cast<char>(std::lround(255 * static_cast<double>(colors.at(i, 0, c))));
  return base64(bytes);
}

constexpr LogRange ramp_range{1, 10};

/// The values that are at these levels, 0 to 1, of a range.
Image with_levels(Image levels, const LogRange& range) {
  for (std::size_t i = 0; i < levels.pixels(); ++i)
    levels.plane(0)[i] = static_cast<Real>(range.low * std::pow(range.high / range.low, levels.plane(0)[i]));
  return levels;
}

std::string hash_source(const char* hexadecimal) {
  std::string bytes;
  for (const char* digit = hexadecimal; *digit; digit += 2)
    bytes += static_cast<char>(std::stoi(std::string(digit, 2), nullptr, 16));
  return "sha256-" + base64(bytes);
}

/// Text with each place "%NAME%" replaced. What is put in is not searched again.
std::string filled(const std::string& text, const std::map<std::string, std::string_view>& values) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find('%', at);
    const std::size_t end = begin == std::string::npos ? begin : text.find('%', begin + 1);
    if (end == std::string::npos) return out.append(text, at, std::string::npos);
    out.append(text, at, begin - at).append(values.at(text.substr(begin + 1, end - begin - 1)));
    at = end + 1;
  }
  return out;
}

}  // namespace

ViewerPage::ViewerPage(std::string title, const DisplayParams& display, std::size_t max_bytes)
    : title_(std::move(title)), max_bytes_(max_bytes) {
  Json transforms = Json::array();
  std::size_t chosen = 0;
  const DisplayViews views = display_views(display.view);
  for (const std::string& name : views.names) {
    if (name == views.chosen) chosen = transforms.size();
    Json transform{{"name", readable(name)}};
    if (name != views.plain_srgb) {
      const DisplayTable table = display_table(name);
      transform["table"] = {{"size", table.size},
                            {"scale", table.scale},
                            {"length", table.length},
                            {"block", add_block(packed_samples(table.colors, PageSamples::Half))}};
    }
    transforms.push_back(std::move(transform));
  }
  scene_ = {{"relativeFloor", relmse_floor},
            {"frameName", "frame"},
            {"frames", {""}},
            {"transforms", std::move(transforms)},
            {"transform", chosen},
            {"exposure", display.exposure},
            {"first", 0},
            {"ramps",
             {ramp([](const Image& levels) { return false_color(with_levels(levels, ramp_range), ramp_range); }),
              ramp(flip_color)}},
            {"images", Json::array()},
            {"layers", Json::array()},
            {"notes", Json::array()}};
}

void ViewerPage::set_frames(const std::string& what, const std::vector<std::string>& names) {
  scene_["frameName"] = what;
  scene_["frames"] = readable(names);
}

std::size_t ViewerPage::add_image(const ViewedImage& image) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < scene_["frames"].size(); ++i) frames.push_back(Json::array());
  scene_["images"].push_back(Json{{"name", readable(image.name)},
                                  {"path", readable(image.path)},
                                  {"reference", image.reference},
                                  {"frames", std::move(frames)}});
  return scene_["images"].size() - 1;
}

bool ViewerPage::add_layer(std::size_t image, const std::vector<std::size_t>& frames, const ViewedLayer& layer,
                           const Image& values, bool are_halves) {
  const bool halves = are_halves || (!layer.is_map && fit_into_halves(values));
  std::string text = packed_samples(values, halves ? PageSamples::Half : PageSamples::Float);
  if (blocks_.size() + text.size() > max_bytes_) return false;
  Json info{{"slot", readable(layer.slot)},           {"label", readable(layer.label)},
            {"channels", readable(layer.channels)},   {"window", {layer.x, layer.y, values.width(), values.height()}},
            {"type", halves ? "half" : "float"},      {"kind", layer.is_map ? "map" : "picture"},
            {"ramp", static_cast<int>(layer.colors)}, {"block", add_block(text)}};
  if (layer.scale) {
    info["range"] = {layer.scale->low, layer.scale->high};
    info["logarithmic"] = layer.scale->logarithmic;
  }
  if (layer.listed) info["listed"] = true;
  if (layer.is_variance) info["meaning"] = "variance";
  const std::size_t index = scene_["layers"].size();
  scene_["layers"].push_back(std::move(info));
  for (const std::size_t frame : frames) scene_["images"][image]["frames"][frame].push_back(index);
  return true;
}

void ViewerPage::add_note(const std::string& text) { scene_["notes"].push_back(readable(text)); }

std::string ViewerPage::html(const std::string& subtitle, const std::string& report) const {
  const std::string title = escaped(title_);
  const std::string header = fmt::format("<h1>{}</h1><p class=\"soft\">{}</p>", title, escaped(subtitle));
  const std::string style_hash = hash_source(viewer_text.style_hash),
                    script_hash = hash_source(viewer_text.script_hash);
  const std::string main = report.empty() ? report : "<main class=\"report\">\n" + report + "</main>";
  const std::string scene = R"(<script type="application/json" id="scene">)" + embedded(scene_) + "</script>";
  return filled(viewer_text.page, {{"TITLE", title},
                                   {"HEADER", header},
                                   {"STYLE", viewer_text.style},
                                   {"SCRIPT", viewer_text.script},
                                   {"STYLE_HASH", style_hash},
                                   {"SCRIPT_HASH", script_hash},
                                   {"VIEWER", viewer_text.viewer},
                                   {"REPORT", main},
                                   {"SCENE", scene},
                                   {"BLOCKS", blocks_}});
}

std::string ViewerPage::add_block(const std::string& text) {
  std::string id = fmt::format("block{}", block_count_++);
  // Browsers read a comment three times as fast as the text of an element.
  blocks_ += fmt::format(R"(<div hidden id="{}"><!--)", id) + text + "--></div>\n";
  return id;
}

}  // namespace polyrecon
