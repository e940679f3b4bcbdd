#!/usr/bin/env python3
"""Draws docs/results/roofline.png and prints the table of docs/results/performance.md: how far the inner parts are from
what a core can do. Runs the program `benchmarks` of the dev preset (one thread); needs matplotlib. Half a minute."""

import argparse
import json
import pathlib
import subprocess

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARTS = {
    "patch_distances/stride:4": "patch distances",
    "factorise_window/order:2": "factorise, order 2",
    "factorise_window/order:4": "factorise, order 4",
    "project_beauty_window/order:2": "project_beauty, order 2",
    "project_beauty_window/order:4": "project_beauty, order 4",
}
PEAKS = {"peak<float>": "float, in registers", "peak<double>": "double, in registers"}
LEVELS = {"bandwidth/KiB:24": "L1", "bandwidth/KiB:1024": "L2", "bandwidth/KiB:1048576": "memory"}


def rates(program):
    command = [
        program,
        "--benchmark_format=json",
        "--benchmark_filter=" + "|".join([*PARTS, *PEAKS, *LEVELS]),
        "--benchmark_repetitions=5",
    ]
    measured = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["benchmarks"]
    best = {}
    for row in measured:  # the best of five: what disturbs only ever takes time
        if row["run_type"] == "iteration":
            mine = best.setdefault(row["run_name"], {"flop": 0, "bytes": 0})
            mine.update({key: max(mine[key], row.get(key, 0)) for key in mine})
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/dev/tests/bench/benchmarks")
    best = rates(parser.parse_args().program)
    figure, axes = plt.subplots(figsize=(7, 4.5))
    intensity = np.logspace(-1.5, 2, 100)
    peak = best["peak<float>"]["flop"]
    for name, label in LEVELS.items():
        axes.plot(intensity, np.minimum(intensity * best[name]["bytes"], peak) / 1e9, color="grey")
        axes.text(
            0.035, 0.04 * best[name]["bytes"] / 1e9, f"{label}: {best[name]['bytes'] / 1e9:.0f} GB/s", rotation=32
        )
    for name, label in PEAKS.items():
        axes.axhline(best[name]["flop"] / 1e9, color="grey", linestyle=":")
        axes.text(100, best[name]["flop"] / 1e9 * 1.05, f"{label}: {best[name]['flop'] / 1e9:.0f} Gflop/s", ha="right")
    print("| part | flop/byte | Gflop/s | GB/s | of the roof of L1 | of L2 |\n|---|---:|---:|---:|---:|---:|")
    for name, label in PARTS.items():
        flop, moved = best[name]["flop"], best[name]["bytes"]
        roofs = [
            flop / min(flop / moved * best[level]["bytes"], best["peak<double>"]["flop"]) for level in list(LEVELS)[:2]
        ]
        axes.plot(flop / moved, flop / 1e9, "o", label=label)
        print(
            f"| {label} | {flop / moved:.2f} | {flop / 1e9:.1f} | {moved / 1e9:.1f} | {roofs[0]:.0%} | {roofs[1]:.0%} |"
        )
    axes.set(xscale="log", yscale="log", xlabel="operations a byte loaded or stored", ylabel="Gflop/s, one thread")
    axes.legend()
    figure.savefig(ROOT / "docs" / "results" / "roofline.png", dpi=80, bbox_inches="tight")


if __name__ == "__main__":
    main()
