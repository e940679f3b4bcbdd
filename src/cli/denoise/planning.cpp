#include "cli/denoise/planning.h"

#include <fmt/format.h>

#include <algorithm>

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

constexpr double write_over_read = 4;   // docs/results/performance.md: compressing, and reading back to check
constexpr double skipped = 0.1;         // of the error to reach: pixels with less noise hardly count in its mean
constexpr double least_seconds = 1e-3;  // a budget that is spent already still asks for the fastest settings

Json json_of(const PlannedStep& step) {
  return {{"settings", step.name}, {"seconds", step.seconds}, {"relmse", step.relative_mse}};
}

}  // namespace

FramePlan read_frame_header(const DenoiseOptions& o, const Frame& frame, double read_seconds, Progress& progress) {
  FramePlan out;
  out.pilot = run_pilot(frame, progress);
  if (o.time_budget > 0)
    out.request.seconds =
        std::max(o.time_budget - (1 + write_over_read) * read_seconds - out.pilot.spent, least_seconds);
  if (o.sample_map.empty()) out.request.relative_mse = o.sampling.params.target;
  out.plan = make_plan(out.pilot, out.request, measured_steps());
  out.params = with_options(out.plan.params, o);
  out.params.enough = skipped * out.request.relative_mse;
  return out;
}

std::string plan_text(const FramePlan& p, double seconds) {
  const PlannedStep& step = p.plan.step;
  std::string text = fmt::format("{}: {:.2g} s and relMSE {:.3g} predicted from {:.0f} % of the frame, {:.2g} s taken",
                                 step.name, step.seconds, step.relative_mse, 100 * p.pilot.share, seconds);
  if (!p.plan.met) text += "; what was asked for cannot be met";
  if (p.plan.next)
    text += fmt::format("; the next step, {}, would cost {:.2g}x the time for {:.1f} % less error", p.plan.next->name,
                        p.plan.next->seconds / step.seconds, 100 * (1 - p.plan.next->relative_mse / step.relative_mse));
  else
    text += "; there is no more accurate step: further samples are what helps";
  return text;
}

Json plan_json(const FramePlan& p, double seconds) {
  return {{"met", p.plan.met},
          {"seconds_asked_for", p.request.seconds > 0 ? Json(p.request.seconds) : Json()},
          {"relmse_asked_for", p.request.relative_mse > 0 ? Json(p.request.relative_mse) : Json()},
          {"pilot", {{"share_of_frame", p.pilot.share}, {"seconds", p.pilot.spent}}},
          {"chosen", json_of(p.plan.step)},
          {"seconds_taken", seconds},
          {"next", p.plan.next ? json_of(*p.plan.next) : Json()}};
}

}  // namespace polyrecon
