#include "sweep/setting.h"

#include <algorithm>

#include "noise/variance.h"
#include "presets/preset.h"

namespace polyrecon {
namespace {

/// Collects settings that differ from Quality::Standard in one thing.
class Settings {
 public:
  explicit Settings(const std::vector<std::string>& groups) : groups_(groups) {}

  bool wants(const std::string& group) const {
    return std::find(groups_.begin(), groups_.end(), group) != groups_.end();
  }
  /// Names are unique: a second setting of the same name is ignored.
  void add(const Setting& setting) {
    const auto same = [&](const Setting& s) { return s.name == setting.name; };
    if (wants(setting.group) && std::none_of(list_.begin(), list_.end(), same)) list_.push_back(setting);
  }
  template <typename Change>
  void vary(const std::string& group, const std::string& name, const Change& change) {
    Setting setting{name, group, params_for(Quality::Standard)};
    change(setting);
    add(setting);
  }
  /// One setting for each value of a parameter other than that of Quality::Standard.
  template <typename Value>
  void vary(const std::string& group, Value Params::*member, const std::vector<Value>& values) {
    for (const Value value : values)
      if (value != params_for(Quality::Standard).*member)
        vary(group, group + " " + std::to_string(value), [&](Setting& s) { s.params.*member = value; });
  }
  std::vector<Setting> take() { return std::move(list_); }

 private:
  const std::vector<std::string>& groups_;
  std::vector<Setting> list_;
};

bool has_feature(const Frame& frame, Role role) {
  return std::any_of(frame.features.begin(), frame.features.end(), [&](const Feature& f) { return f.role == role; });
}

bool may_be_prefiltered(const Feature& feature) {
  const bool known = feature.pass.noise_is_known();
  return known || noise_is_estimated(feature.role, known);
}

void add_numbers(const Frame& frame, Settings& list) {
  list.vary<int>("stages", &Params::stages, {1, 3});
  list.vary<int>("levels", &Params::levels, {1, 2, 4});
  list.vary<int>("stride", &Params::stride, {2, 3, 6, 8});
  list.vary<int>("radius", &Params::radius, {5, 7, 12});
  list.vary<int>("order", &Params::max_order, {0, 1, 3});
  list.vary("coverage", "coverage 0", [](Setting& s) { s.params.coverage = 0; });
  list.vary("coverage", "coverage 6", [](Setting& s) { s.params.coverage = 6; });
  const Params standard = params_for(Quality::Standard);
  for (const int radius : {0, 1, 2, 3})
    if (radius != (noise_is_measured(frame) ? standard.patch.radius : standard.estimated_patch.radius))
      list.vary("patch", "patch " + std::to_string(radius),
                [&](Setting& s) { s.params.patch.radius = s.params.estimated_patch.radius = radius; });
}

void add_bandwidths(Settings& list) {
  list.vary("bandwidths", "one bandwidth",
            [](Setting& s) { s.params.first_bandwidths = s.params.later_bandwidths = {Real(0.7)}; });
  list.vary("bandwidths", "four bandwidths", [](Setting& s) {
    s.params.first_bandwidths = s.params.later_bandwidths = {Real(0.35), Real(0.5), Real(0.7), Real(1)};
  });
  list.vary("bandwidths", "one guided bandwidth", [](Setting& s) { s.params.guided_bandwidths = {Real(0.7)}; });
  list.vary("bandwidths", "no guided windows", [](Setting& s) { s.params.guided_bandwidths.clear(); });
}

void add_inputs(const Frame& frame, Settings& list) {
  for (const RoleInfo& info : role_table())
    if (has_feature(frame, info.role))
      list.vary("features", std::string("without ") + info.name,
                [&](Setting& s) { s.params.steps.features.erase(info.role); });
  if (!frame.features.empty())
    list.vary("features", "without features", [](Setting& s) { s.params.steps.features.clear(); });
  if (frame.beauty.has_halves())
    list.vary("halves", "without half buffers", [](Setting& s) { s.without_halves = true; });
  if (!frame.prior.mean.empty()) list.vary("prior", "without prior", [](Setting& s) { s.without_prior = true; });
}

/// The ablation of docs/results/accuracy.md: each setting disables one component of the method. Components that a
/// number disables are in the other groups: stages 1, levels 1, order 0, coverage 0, no guided windows, features,
/// halves, prior.
void add_ablation(const Frame& frame, Settings& list) {
  const auto without = [&](const char* name, const auto& change) { list.vary("ablation", name, change); };
  without("weights from the same half", [](Setting& s) { s.params.components.cross_filter = false; });
  without("no shrinkage", [](Setting& s) { s.params.components.shrinkage = false; });
  without("no patch weights", [](Setting& s) {
    s.params.first_bandwidths = s.params.later_bandwidths = {Real(1e6)};  // all pixels of a window weigh the same
    s.params.guided_bandwidths.clear();
  });
  without("choice by wide regions", [](Setting& s) { s.params.selection.risk_sigma = 20; });
  without("one stage, one level", [](Setting& s) { s.params.stages = s.params.levels = 1; });
  without("no firefly removal", [](Setting& s) { s.params.steps.fireflies = false; });
  without("no variance floor", [](Setting& s) { s.params.components.variance_floor = false; });
  if (std::any_of(frame.features.begin(), frame.features.end(), may_be_prefiltered))
    without("no feature prefilter", [](Setting& s) { s.params.steps.prefilter = false; });
  without("no noise bound", [](Setting& s) { s.params.components.noise_bound = false; });
  without("no raising of undershoot", [](Setting& s) { s.params.components.raise_undershoot = false; });
  without("totals not restored", [](Setting& s) { s.params.components.restore_totals = false; });
  without("order by least error alone", [](Setting& s) { s.params.order_tolerance = 0; });
  without("all steps", [](Setting& s) { s.params.steps.decide = false; });
}

}  // namespace

const std::vector<std::string>& setting_groups() {
  static const std::vector<std::string> groups{"quality",  "presets", "stages",   "levels",  "stride",
                                               "radius",   "order",   "coverage", "patch",   "bandwidths",
                                               "features", "halves",  "prior",    "ablation"};
  return groups;
}

std::vector<Setting> settings_for(const Frame& frame, const std::vector<std::string>& groups) {
  Settings list(groups);
  for (const NamedQuality& named : qualities)
    if (named.quality != Quality::Standard) list.add({named.name, "quality", params_for(named.quality)});
  add_numbers(frame, list);
  add_bandwidths(list);
  add_inputs(frame, list);
  add_ablation(frame, list);
  for (const Preset& preset : presets())
    if (preset.name != "standard") list.add({preset.name, "presets", preset.params});
  std::vector<Setting> settings{{"standard", "quality", params_for(Quality::Standard)}};
  for (Setting& setting : list.take()) settings.push_back(std::move(setting));
  return settings;
}

Frame frame_for(const Frame& frame, const Setting& setting) {
  Frame out = frame;
  if (setting.without_prior) out.prior = {};
  if (!setting.without_halves) return out;
  const auto drop = [](Pass& pass) { pass.half_a = pass.half_b = Image(); };
  drop(out.beauty);
  for (Feature& feature : out.features) drop(feature.pass);
  for (Pass& aov : out.aovs) drop(aov);
  return out;
}

}  // namespace polyrecon
