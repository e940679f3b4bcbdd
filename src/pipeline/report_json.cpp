#include "pipeline/report_json.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN: what is not finite is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json rgb(const std::array<double, 3>& v) { return Json::array({number(v[0]), number(v[1]), number(v[2])}); }

double pixels_of(const Report& r) { return static_cast<double>(r.width) * static_cast<double>(r.height); }

Json windows_json(const Report& r) {
  Json per_order{{"constant", r.windows_per_order[0]}};
  for (std::size_t k = 1; k < r.windows_per_order.size(); ++k)
    per_order[std::to_string(k - 1)] = r.windows_per_order[k];
  return {{"count", r.windows}, {"per_order", per_order}, {"rank_deficient", r.rank_deficient_windows}};
}

Json phases_json(const std::vector<PhaseTime>& phases) {
  Json list = Json::array();
  for (const PhaseTime& phase : phases) list.push_back({{"phase", phase.phase}, {"seconds", phase.seconds}});
  return list;
}

}  // namespace

double reconstruction_seconds(const Report& r) {
  double sum = 0;
  for (const PhaseTime& phase : r.phases) sum += phase.seconds;
  return sum;
}

double pixels_per_second(const Report& r) {
  const double seconds = reconstruction_seconds(r);
  return seconds > 0 ? pixels_of(r) / seconds : 0;
}

double energy_change(const Report& r) {
  const double before = r.energy_before[0] + r.energy_before[1] + r.energy_before[2];
  const double after = r.energy_after[0] + r.energy_after[1] + r.energy_after[2];
  return before != 0 ? after / before - 1 : 0;
}

Json decisions_json(const std::vector<Decision>& decisions) {
  auto list = Json::array();
  for (const Decision& d : decisions)
    list.push_back({{"step", d.step}, {"run", d.run}, {"reason", d.reason}, {"saved_seconds", d.saved_seconds}});
  return list;
}

Json report_json(const Report& r) {
  return {{"width", r.width},
          {"height", r.height},
          {"variance_source", r.variance_source},
          {"decisions", decisions_json(r.decisions)},
          {"phases", phases_json(r.phases)},
          {"pixels_per_second", pixels_per_second(r)},
          {"neighbours",
           {{"frames", r.neighbours},
            {"mean_weight", number(r.neighbour_weight)},
            {"shared_noise", number(r.neighbour_shared_noise)}}},
          {"windows", windows_json(r)},
          {"corrections",
           {{"windows_not_finite", r.windows_not_finite},
            {"pixels_kept_noisy", r.pixels_kept_noisy},
            {"pixels_raised_to_input", r.pixels_raised_to_input}}},
          {"repaired_pixels", r.repaired_pixels},
          {"negative_pixels", r.negative_pixels},
          {"fireflies", {{"count", r.outliers}, {"energy", rgb(r.outlier_energy)}}},
          {"energy",
           {{"before", rgb(r.energy_before)},
            {"after", rgb(r.energy_after)},
            {"restored_gain", rgb(r.restored_gain)},
            {"channel_change", rgb(r.energy_change)},
            {"relative_change", number(energy_change(r))}}},
          {"estimated_relmse", number(r.estimated_relative_mse)}};
}

}  // namespace polyrecon
