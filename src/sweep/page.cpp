#include "sweep/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "html/escaped.h"
#include "html/plot.h"
#include "html/viewer_page.h"
#include "io/pictures/color.h"
#include "polyrecon/params.h"
#include "presets/pareto.h"

namespace polyrecon {
namespace {

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

/// The images of the viewer: the index of each trial's and each peer's, as far as the page has room for them.
struct PicturedSweep {
  std::map<std::size_t, std::size_t> trials, peers;
  bool complete = true;
};

/// The address that shows an image next to the reference, the second image of the page; empty where the page lacks it.
std::string address_of(const std::map<std::size_t, std::size_t>& images, std::size_t index) {
  const auto at = images.find(index);
  return at == images.end() ? std::string() : fmt::format("#a={}&amp;b=1", at->second);
}

std::string linked(const std::string& name, const std::string& address) {
  return address.empty() ? escaped(name) : fmt::format("<a href=\"{}\">{}</a>", address, escaped(name));
}

std::string details_of(const Trial& trial) {
  return fmt::format("{:.3g} s, relMSE {:.4g}", trial.seconds, trial.score.relative_mse);
}

std::string details_of(const Peer& peer) {
  return fmt::format("{:.3g} s, relMSE {:.4g}", peer.seconds, peer.score.relative_mse);
}

/// Time and error of each setting, coloured by what was varied.
std::string front_section(const Sweep& sweep, const PicturedSweep& pictured) {
  const SweptInput& input = sweep.inputs.front();
  LogPlot plot{"seconds", "relMSE", {}, {}, {{"noisy input", input.noisy.relative_mse}}};
  for (const std::string& group : setting_groups()) {
    PlotSeries series{group, plot_color(plot.series.size()), Marker::Disc, false, {}};
    for (std::size_t i = 0; i < input.trials.size(); ++i)
      if (const Trial& trial = input.trials[i]; trial.group == group)
        series.points.push_back(
            {trial.seconds, trial.score.relative_mse, trial.name, details_of(trial), address_of(pictured.trials, i)});
    if (group == "quality") series.marker = Marker::Square;
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  PlotSeries peers{"other programs", "#000", Marker::Diamond, false, {}};
  peers.color = "var(--text)";
  for (std::size_t i = 0; i < sweep.peers.size(); ++i)
    peers.points.push_back({sweep.peers[i].seconds, sweep.peers[i].score.relative_mse, sweep.peers[i].name,
                            details_of(sweep.peers[i]), address_of(pictured.peers, i)});
  plot.series.push_back(std::move(peers));
  for (const std::size_t i : front_of(input))
    plot.front.emplace_back(input.trials[i].seconds, input.trials[i].score.relative_mse);
  return "<h2>Accuracy against time</h2>\n<p class='soft'>Further left is faster, further down is more accurate. The "
         "line "
         "connects the settings that no other one beats in both. Each setting but the presets differs from "
         "standard in one thing. A click on a point shows its picture above, next to the reference.</p>\n" +
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

/// Adds an image with its relative error; returns whether the page had room for it.
bool add_picture(ViewerPage& page, std::size_t image, const Image& beauty, const Image* reference) {
  if (!page.add_layer(image, {0}, {"", "RGB", {"R", "G", "B"}}, beauty, false)) return false;
  if (!reference) return true;
  ViewedLayer error{"relMSE", "relative error", {"Y"}, 0, 0, true};
  const Image values = relative_error(beauty, *reference);
  if (const LogRange range = log_range(values); range.high > range.low)
    error.scale = MapScale{range.low, range.high, true};
  error.listed = true;
  page.add_layer(image, {0}, error, values, false);
  return true;
}

/// Noisy input, reference, other programs and settings, those of the front first. As many as the page has room for.
PicturedSweep add_pictures(ViewerPage& page, const Sweep& sweep) {
  const SweptInput& input = sweep.inputs.front();
  PicturedSweep pictured;
  const Image& reference = sweep.reference.mean;
  const std::size_t noisy = page.add_image({"noisy input", input.name}),
                    truth = page.add_image({"reference", sweep.reference_name, true});
  pictured.complete =
      add_picture(page, noisy, input.beauty, &reference) && add_picture(page, truth, reference, nullptr);
  const auto add = [&](const std::string& name, const std::string& details, const Image& beauty,
                       std::map<std::size_t, std::size_t>& images, std::size_t index) {
    if (!pictured.complete) return;
    const std::size_t image = page.add_image({name, details});
    pictured.complete = add_picture(page, image, beauty, &reference);
    if (pictured.complete) images[index] = image;
  };
  const auto add_trial = [&](std::size_t i) {
    if (pictured.trials.count(i) == 0)
      add(input.trials[i].name, details_of(input.trials[i]), input.trials[i].beauty, pictured.trials, i);
  };
  for (const std::size_t i : front_of(input)) add_trial(i);
  for (std::size_t i = 0; i < sweep.peers.size(); ++i)
    add(sweep.peers[i].name, details_of(sweep.peers[i]), sweep.peers[i].beauty, pictured.peers, i);
  for (std::size_t i = 0; i < input.trials.size(); ++i) add_trial(i);
  if (!pictured.complete)
    page.add_note(
        "Some pictures were left out, as the page would be larger than --max-size: their points have no link.");
  return pictured;
}

std::string row_of(const Trial& trial, const Trial& standard, bool on_front, const std::string& address) {
  return fmt::format(
      "<tr{}><td>{}</td><td class='text'>{}</td><td>{:.3g}</td><td>{:.2f}</td><td>{:.4g}</td><td>{:.3f}</td>"
      "<td>{:.4g}</td><td>{:+.3f} %</td><td>{:.4g}</td></tr>\n",
      on_front ? " class='front'" : "", linked(trial.name, address), escaped(trial.group), trial.seconds,
      trial.seconds / standard.seconds, trial.score.relative_mse,
      trial.score.relative_mse / standard.score.relative_mse, trial.score.trimmed, 100 * trial.score.energy,
      trial.estimated_relative_mse);
}

std::string figures_section(const Sweep& sweep, const PicturedSweep& pictured) {
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
      html += row_of(input.trials[i], input.trials.front(), std::find(front.begin(), front.end(), i) != front.end(),
                     &input == &sweep.inputs.front() ? address_of(pictured.trials, i) : std::string());
    for (std::size_t i = 0; i < sweep.peers.size() && &input == &sweep.inputs.front(); ++i) {
      const Peer& peer = sweep.peers[i];
      html += fmt::format(
          "<tr><td>{}</td><td class='text'>other program</td><td>{:.3g}</td><td>{:.2f}</td><td>{:.4g}</td>"
          "<td>{:.3f}</td><td>{:.4g}</td><td>{:+.3f} %</td><td></td></tr>\n",
          linked(peer.name, address_of(pictured.peers, i)), peer.seconds, peer.seconds / input.trials.front().seconds,
          peer.score.relative_mse, peer.score.relative_mse / input.trials.front().score.relative_mse,
          peer.score.trimmed, 100 * peer.score.energy);
    }
    html += fmt::format(
        "<tr><td>noisy input</td><td class='text'></td><td></td><td></td><td>{:.4g}</td><td>{:.3f}</td>"
        "<td>{:.4g}</td><td>{:+.3f} %</td><td></td></tr>\n</table></div>\n",
        input.noisy.relative_mse, input.noisy.relative_mse / input.trials.front().score.relative_mse,
        input.noisy.trimmed, 100 * input.noisy.energy);
  }
  return html;
}

}  // namespace

std::string page_of(const Sweep& sweep, const std::string& version, std::size_t max_bytes) {
  const SweptInput& input = sweep.inputs.front();
  ViewerPage page("What accuracy costs: " + input.name, {}, max_bytes);
  const PicturedSweep pictured = add_pictures(page, sweep);
  const std::string subtitle = fmt::format(
      "{} x {} pixels{}; measured against {}; polyrecon {}, {} threads; seconds of the reconstruction, "
      "without files",
      input.beauty.width(), input.beauty.height(), input.samples > 0 ? ", " + samples_text(input.samples) : "",
      sweep.reference_name, version, sweep.threads);
  return page.html(subtitle, front_section(sweep, pictured) + price_section(input) + samples_section(sweep) +
                                 phases_section(input) + figures_section(sweep, pictured));
}

}  // namespace polyrecon
