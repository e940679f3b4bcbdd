#include "sweep/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "html/page.h"
#include "html/plot.h"
#include "io/pictures/preview.h"
#include "polyrecon/params.h"
#include "presets/pareto.h"
#include "sweep/pictures.h"

namespace polyrecon {
namespace {

constexpr std::size_t pictured_points = 4;  // settings of the front that get a picture, the first and last included

constexpr int page_width = 1080;  // CSS pixels

constexpr const char* rules = R"(
svg{width:100%;height:auto;display:block}
svg text{fill:var(--text);font-size:12px}svg .label{font-size:11px;text-anchor:middle}svg .tick{fill:var(--soft)}
.grid{stroke:var(--line);stroke-width:1}.level{stroke:var(--soft);stroke-dasharray:5 4}
.front{fill:none;stroke:var(--text);stroke-width:2;opacity:.55}.joined{fill:none;stroke-width:1.5;opacity:.8}
.leader{stroke-width:.8;opacity:.6}.point{stroke:var(--ground);stroke-width:1}
.legend span{margin-right:1.1rem;white-space:nowrap}.legend i{display:inline-block;width:.75rem;height:.75rem;
 border-radius:2px;margin-right:.35rem}
table{width:100%}tr.front td{background:var(--shade);font-weight:600}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(300px,1fr));gap:1rem}
figure{margin:0}figure img{width:100%;display:block;image-rendering:pixelated;margin-bottom:3px}
figcaption{color:var(--soft)}
)";

CostPoint cost_of(const Trial& trial) { return {trial.seconds, trial.score.relative_mse}; }

/// The Pareto front of an input's trials, as indices.
std::vector<std::size_t> front_of(const SweptInput& input) {
  std::vector<CostPoint> points;
  for (const Trial& trial : input.trials) points.push_back(cost_of(trial));
  return pareto_front(points);
}

std::string samples_text(double samples) { return samples > 0 ? fmt::format("{:g} spp", samples) : std::string(); }

std::string percent(double factor) { return fmt::format("{:+.1f} %", 100 * (factor - 1)); }

/// The price of 10 % less error; where the error hardly falls, only that it is high.
std::string price_text(const CostPoint& cheap, const CostPoint& dear, const char* what) {
  const double price = price_of_ten_percent(cheap, dear);
  return price > 100 ? fmt::format("10 % less error costs over 100x the {}", what)
                     : fmt::format("10 % less error costs {:.3g}x the {}", price, what);
}

std::string header(const Sweep& sweep, const std::string& version) {
  const SweptInput& input = sweep.inputs.front();
  return page_head("Sweep of " + input.name, page_width, rules) +
         fmt::format(
             "<h1>What accuracy costs: {}</h1>\n<p class='soft'>{} x {} pixels{}; measured against {}; polyrecon {}, "
             "{} "
             "threads; seconds of the reconstruction, without files</p>\n",
             escaped(input.name), input.beauty.width(), input.beauty.height(),
             input.samples > 0 ? ", " + samples_text(input.samples) : "", escaped(sweep.reference_name),
             escaped(version), sweep.threads);
}

std::string details_of(const Trial& trial) {
  return fmt::format("{:.3g} s, relMSE {:.4g}", trial.seconds, trial.score.relative_mse);
}

/// Time and error of each setting, coloured by what was varied.
std::string front_section(const Sweep& sweep) {
  const SweptInput& input = sweep.inputs.front();
  LogPlot plot{"seconds", "relMSE", {}, {}, {{"noisy input", input.noisy.relative_mse}}};
  for (const std::string& group : setting_groups()) {
    PlotSeries series{group, plot_color(plot.series.size()), Marker::Disc, false, {}};
    for (const Trial& trial : input.trials)
      if (trial.group == group)
        series.points.push_back({trial.seconds, trial.score.relative_mse, trial.name, details_of(trial)});
    if (group == "quality") series.marker = Marker::Square;
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  PlotSeries peers{"other programs", "#000", Marker::Diamond, false, {}};
  peers.color = "var(--text)";
  for (const Peer& peer : sweep.peers)
    peers.points.push_back({peer.seconds, peer.score.relative_mse, peer.name,
                            fmt::format("{:.3g} s, relMSE {:.4g}", peer.seconds, peer.score.relative_mse)});
  plot.series.push_back(std::move(peers));
  for (const std::size_t i : front_of(input))
    plot.front.emplace_back(input.trials[i].seconds, input.trials[i].score.relative_mse);
  return "<h2>Accuracy against time</h2>\n<p class='soft'>Further left is faster, further down is more accurate. The "
         "line "
         "connects the settings that no other one beats in both. Each setting but the presets differs from "
         "standard in one thing.</p>\n" +
         svg_of(plot);
}

std::string price_section(const SweptInput& input) {
  const std::vector<std::size_t> front = front_of(input);
  std::string html =
      "<h2>What accuracy costs</h2>\n<p class='soft'>Along the line above: from each setting to the next one.</p>\n"
      "<div class='table'><table><tr><th>setting</th><th>seconds</th><th>relMSE</th><th>time</th><th>error</th>"
      "<th class='text'>price</th></tr>\n";
  for (std::size_t k = 0; k < front.size(); ++k) {
    const Trial& trial = input.trials[front[k]];
    html += fmt::format("<tr><td>{}</td><td>{:.3g}</td><td>{:.4g}</td>", escaped(trial.name), trial.seconds,
                        trial.score.relative_mse);
    if (k == 0) {
      html += "<td></td><td></td><td class='text'></td></tr>\n";
      continue;
    }
    const CostPoint before = cost_of(input.trials[front[k - 1]]), now = cost_of(trial);
    html += fmt::format("<td>{}</td><td>{}</td><td class='text'>{}</td></tr>\n", percent(now.seconds / before.seconds),
                        percent(now.error / before.error), price_text(before, now, "time"));
  }
  return html + "</table></div>\n";
}

/// Error over samples per pixel, of the noisy renders and of each quality's results.
std::string samples_section(const Sweep& sweep) {
  std::vector<const SweptInput*> inputs;
  for (const SweptInput& input : sweep.inputs)
    if (input.samples > 0) inputs.push_back(&input);
  if (inputs.size() < 2) return {};
  std::sort(inputs.begin(), inputs.end(), [](const auto* a, const auto* b) { return a->samples < b->samples; });
  LogPlot plot{"samples per pixel", "relMSE", {{"noisy input", plot_color(9), Marker::Diamond, true, {}}}, {}, {}};
  for (const SweptInput* input : inputs)
    plot.series[0].points.push_back({input->samples, input->noisy.relative_mse, "", input->name});
  std::string rows;
  for (const NamedQuality& named : qualities) {
    const char* const quality = named.name;
    PlotSeries series{quality, plot_color(plot.series.size() - 1), Marker::Square, true, {}};
    CostPoint before;
    for (const SweptInput* input : inputs) {
      const auto at =
          std::find_if(input->trials.begin(), input->trials.end(), [&](const Trial& t) { return t.name == quality; });
      if (at == input->trials.end()) continue;
      series.points.push_back({input->samples, at->score.relative_mse, "", details_of(*at)});
      const CostPoint now{input->samples, at->score.relative_mse};
      if (before.seconds > 0 && now.error < before.error && now.error > 0)
        rows += fmt::format(
            "<tr><td>{}</td><td>{:g} to {:g}</td><td>{:.4g} to {:.4g}</td><td class='text'>{}</td></tr>\n", quality,
            before.seconds, now.seconds, before.error, now.error, price_text(before, now, "samples"));
      before = now;
    }
    plot.series.push_back(std::move(series));
  }
  return "<h2>Samples</h2>\n<p class='soft'>The same frame rendered with more samples.</p>\n" + svg_of(plot) +
         "<div class='table'><table><tr><th>setting</th><th>samples</th><th>relMSE</th><th "
         "class='text'>price</th></tr>\n" +
         rows + "</table></div>\n";
}

std::string phases_section(const SweptInput& input) {
  StackedBars bars{"s", {}, {}};
  std::vector<std::size_t> shown = front_of(input);
  for (std::size_t i = 0; i < input.trials.size(); ++i)
    if (input.trials[i].group == "quality" && std::find(shown.begin(), shown.end(), i) == shown.end())
      shown.push_back(i);
  std::sort(shown.begin(), shown.end(),
            [&](std::size_t a, std::size_t b) { return input.trials[a].seconds < input.trials[b].seconds; });
  for (const PhaseTime& phase : input.trials.front().phases) bars.parts.push_back(phase.phase);
  for (const std::size_t i : shown) {
    StackedBars::Row row{input.trials[i].name, std::vector<double>(bars.parts.size(), 0)};
    for (const PhaseTime& phase : input.trials[i].phases)
      for (std::size_t k = 0; k < bars.parts.size(); ++k)
        if (bars.parts[k] == phase.phase) row.values[k] += phase.seconds;
    bars.rows.push_back(std::move(row));
  }
  return "<h2>Time by phase</h2>\n" + svg_of(bars);
}

/// The fastest and the most accurate setting of the front, and some between.
std::vector<std::size_t> pictured(const SweptInput& input) {
  std::vector<std::size_t> front = front_of(input);
  if (front.size() <= pictured_points) return front;
  std::vector<std::size_t> some;
  for (std::size_t k = 0; k < pictured_points; ++k)
    some.push_back(front[k * (front.size() - 1) / (pictured_points - 1)]);
  return some;
}

std::string pictures_section(const Sweep& sweep) {
  const SweptInput& input = sweep.inputs.front();
  std::vector<Picture> pictures{
      {"noisy input", "relMSE " + fmt::format("{:.4g}", input.noisy.relative_mse), &input.beauty}};
  for (const std::size_t i : pictured(input))
    pictures.push_back({input.trials[i].name, details_of(input.trials[i]), &input.trials[i].beauty});
  for (const Peer& peer : sweep.peers)
    pictures.push_back(
        {peer.name, fmt::format("{:.3g} s, relMSE {:.4g}", peer.seconds, peer.score.relative_mse), &peer.beauty});
  pictures.push_back({"reference", sweep.reference_name, &sweep.reference.mean});
  std::string html =
      "<h2>Pictures</h2>\n<p class='soft'>The frame, a part of it enlarged where the results are worst, and the "
      "squared "
      "relative error of each pixel (logarithmic, one scale for all: black is exact, yellow worst).</p>\n"
      "<div class='pictures'>\n";
  for (const PicturedResult& result : picture_results(pictures, sweep.reference.mean)) {
    html += fmt::format("<figure><img alt='{0}' src='{1}'><img alt='{0}, enlarged' src='{2}'>", escaped(result.name),
                        result.whole, result.part);
    if (!result.error.empty())
      html += fmt::format("<img alt='{}, error' src='{}'>", escaped(result.name), result.error);
    html += fmt::format("<figcaption><b>{}</b><br>{}</figcaption></figure>\n", escaped(result.name),
                        escaped(result.details));
  }
  return html + "</div>\n";
}

std::string row_of(const Trial& trial, const Trial& standard, bool on_front) {
  return fmt::format(
      "<tr{}><td>{}</td><td class='text'>{}</td><td>{:.3g}</td><td>{:.2f}</td><td>{:.4g}</td><td>{:.3f}</td>"
      "<td>{:.4g}</td><td>{:+.3f} %</td><td>{:.4g}</td></tr>\n",
      on_front ? " class='front'" : "", escaped(trial.name), escaped(trial.group), trial.seconds,
      trial.seconds / standard.seconds, trial.score.relative_mse,
      trial.score.relative_mse / standard.score.relative_mse, trial.score.trimmed, 100 * trial.score.energy,
      trial.estimated_relative_mse);
}

std::string figures_section(const Sweep& sweep) {
  std::string html;
  for (const SweptInput& input : sweep.inputs) {
    html += fmt::format("<h2>All figures: {}</h2>\n", escaped(input.name));
    html +=
        "<p class='soft'>Times and errors are also given relative to standard. Trimmed: without the 0.1 % worst "
        "pixels. Energy: the mean relative to the reference's. Estimated: by the error map, which does not know the "
        "reference. Shaded: the front.</p>\n<div class='table'><table><tr><th>setting</th><th class='text'>group</th>"
        "<th>seconds</th><th>/ standard</th><th>relMSE</th><th>/ standard</th><th>trimmed</th><th>energy</th>"
        "<th>estimated</th></tr>\n";
    const std::vector<std::size_t> front = front_of(input);
    for (std::size_t i = 0; i < input.trials.size(); ++i)
      html += row_of(input.trials[i], input.trials.front(), std::find(front.begin(), front.end(), i) != front.end());
    html += fmt::format(
        "<tr><td>noisy input</td><td class='text'></td><td></td><td></td><td>{:.4g}</td><td>{:.3f}</td>"
        "<td>{:.4g}</td><td>{:+.3f} %</td><td></td></tr>\n</table></div>\n",
        input.noisy.relative_mse, input.noisy.relative_mse / input.trials.front().score.relative_mse,
        input.noisy.trimmed, 100 * input.noisy.energy);
  }
  return html;
}

}  // namespace

std::string page_of(const Sweep& sweep, const std::string& version) {
  const SweptInput& input = sweep.inputs.front();
  return header(sweep, version) + front_section(sweep) + price_section(input) + samples_section(sweep) +
         phases_section(input) + pictures_section(sweep) + figures_section(sweep) + page_end();
}

}  // namespace polyrecon
