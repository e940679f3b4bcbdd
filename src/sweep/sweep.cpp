#include "sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace polyrecon {
namespace {

/// The names of all phases, in the order of their first appearance.
std::vector<std::string> phase_names(const Sweep& sweep) {
  std::vector<std::string> names;
  for (const SweptInput& input : sweep.inputs)
    for (const Trial& trial : input.trials)
      for (const PhaseTime& phase : trial.phases)
        if (std::find(names.begin(), names.end(), phase.phase) == names.end()) names.push_back(phase.phase);
  return names;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// CSV has no NaN: values that are not finite are empty.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : std::string(); }

std::string score_fields(const Score& s) {
  return number(s.relative_mse) + "," + number(s.trimmed) + "," + number(s.energy);
}

}  // namespace

Sweep run_sweep(const std::vector<SweepInput>& inputs, const std::vector<std::string>& groups,
                const Reference& reference, std::vector<Peer> peers, Progress& progress) {
  Sweep sweep;
  sweep.reference = reference;
  sweep.threads = processors();
  for (Peer& peer : peers) peer.score = score(peer.beauty, reference.mean, reference.variance);
  sweep.peers = std::move(peers);
  for (const SweepInput& input : inputs) {
    const bool first = sweep.inputs.empty();
    const auto settings = settings_for(input.frame, first ? groups : std::vector<std::string>{"quality"});
    SweptInput swept{input.name,
                     input.samples,
                     score(input.frame.beauty.mean, reference.mean, reference.variance),
                     input.frame.beauty.mean,
                     {}};
    progress.begin(input.name, settings.size());
    for (const Setting& setting : settings) {
      swept.trials.push_back(run_trial(input.frame, setting, reference, progress));
      progress.advance(1);
    }
    progress.end();
    sweep.inputs.push_back(std::move(swept));
  }
  return sweep;
}

std::string csv_of(const Sweep& sweep) {
  const std::vector<std::string> phases = phase_names(sweep);
  std::string csv = "input,samples,group,setting,runs,seconds,relMSE,trimmed,energy,estimated relMSE";
  for (const std::string& phase : phases) csv += "," + phase + " s";
  csv += "\n";
  const std::string no_phases(phases.size(), ',');
  for (const SweptInput& input : sweep.inputs) {
    const std::string head = quoted(input.name) + "," + (input.samples > 0 ? number(input.samples) : "") + ",";
    csv += fmt::format("{}input,noisy,,,{},{}\n", head, score_fields(input.noisy), no_phases);
    for (const Trial& trial : input.trials) {
      csv += head + fmt::format("{},{},{},{},{},{}", trial.group, quoted(trial.name), trial.runs, number(trial.seconds),
                                score_fields(trial.score), number(trial.estimated_relative_mse));
      for (const std::string& name : phases) {
        const auto at = std::find_if(trial.phases.begin(), trial.phases.end(),
                                     [&](const PhaseTime& phase) { return phase.phase == name; });
        csv += "," + (at == trial.phases.end() ? std::string() : number(at->seconds));
      }
      csv += "\n";
    }
  }
  for (const Peer& peer : sweep.peers)
    csv += fmt::format("{},,peer,{},,{},{},{}\n", quoted(sweep.inputs.front().name), quoted(peer.name),
                       number(peer.seconds), score_fields(peer.score), no_phases);
  return csv;
}

}  // namespace polyrecon
