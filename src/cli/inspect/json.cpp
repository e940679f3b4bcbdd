#include "cli/common/advice_output.h"
#include "cli/common/roles_output.h"
#include "cli/inspect/report.h"
#include "io/layers/channel_names.h"
#include "pipeline/report_json.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Rect& r) { return {{"x", r.x0}, {"y", r.y0}, {"width", r.width()}, {"height", r.height()}}; }

Json json_of(const PartInfo& part) {
  auto channels = Json::array();
  for (const ChannelInfo& c : part.channels) channels.push_back({{"name", c.name}, {"type", name_of(c.type)}});
  return {{"name", part.name},
          {"view", part.view},
          {"data_window", json_of(part.data_window)},
          {"display_window", json_of(part.display_window)},
          {"compression", part.compression},
          {"tiled", part.tiled},
          {"deep", part.deep},
          {"readable", part.readable()},
          {"channels", channels}};
}

Json json_of(const Layer& layer, const LayerStatistics* s) {
  Json out{{"name", layer.name},
           {"view_layer", layer.view_layer},
           {"view", layer.view},
           {"file", layer.file},
           {"part", layer.part},
           {"channels", layer.channels},
           {"role", name_of(layer.role)},
           {"holds", name_of(layer.companion)},
           {"of", layer.of},
           {"why", layer.why}};
  if (s)
    out.update({{"nan", s->nan},
                {"infinite", s->infinite},
                {"negative", s->negative},
                {"minimum", s->minimum},
                {"maximum", s->maximum},
                {"mean", s->mean}});
  return out;
}

}  // namespace

nlohmann::ordered_json inspect_json(const InspectReport& report) {
  const Inspection& found = report.file;
  Json files = Json::array(), layers = Json::array(), denoisers = Json::array();
  for (const FoundDenoiser& d : report.denoisers)
    denoisers.push_back({{"prior", d.option}, {"name", d.name}, {"place", d.place}, {"problem", d.problem}});
  for (const FileInfo& file : found.source.files) {
    Json parts = Json::array();
    for (const PartInfo& part : file.parts) parts.push_back(json_of(part));
    files.push_back({{"path", file.path}, {"format", file.format}, {"bytes", file.bytes}, {"parts", parts}});
  }
  for (const Layer& layer : found.source.layers) layers.push_back(json_of(layer, found.statistics_of(layer.name)));
  return {{"files", files},
          {"layers", layers},
          {"view_layer", found.source.view_layer},
          {"roles", roles_json(found.source)},
          {"missing", found.missing},
          {"advice", advice_json(report.advice)},
          {"samples", found.samples > 0 ? Json(found.samples) : Json()},
          {"noise_level", found.noise_level >= 0 ? Json(found.noise_level) : Json()},
          {"steps", decisions_json(report.steps)},
          {"denoisers", denoisers},
          {"notes", found.notes}};
}

}  // namespace polyrecon
