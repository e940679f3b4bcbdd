#!/usr/bin/env python3
"""Draws docs/dev/stability_*.png and prints the tables of docs/dev/stability.md: the condition of the windows met
on the samples, what each solver makes of them, and what the limits of regression/least_squares.h do. Builds on the dev
preset's program `stability`; needs matplotlib. Under a minute."""

import argparse
import pathlib
import subprocess

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = {"study_16": "study", "glass_16": "glass", "lighthouse_16": "lighthouse", "study_denoised_16": "study"}
SOLVERS = ("chosen", "hardly any limits", "QR in float", "normal equations in double", "normal equations in float")
LABELS = {"chosen": "ours", "hardly any limits": "ours, limits of 1e-7 and 0"}
LAPACK_LIMIT = 30
REMAINDER, VARIATION = 0.03, 2e-4  # DependenceLimits


def table(folder, name):
    return np.genfromtxt(folder / name, delimiter=",", names=True, dtype=None, encoding="utf-8", deletechars="")


def field(rows, name):
    return rows[name.replace(" ", "_")]


def save(figure, name):
    figure.savefig(ROOT / "docs" / "dev" / f"stability_{name}.png", dpi=80, bbox_inches="tight")


def draw_conditions(windows):
    figure, axes = plt.subplots(figsize=(7, 3.5))
    condition = np.minimum(windows["condition"], 1e18)
    edges = np.logspace(0, 18, 73)
    print("| sample | windows | of lower rank | condition: median | 90 % | 99 % |\n|---|---:|---:|---:|---:|---:|")
    for sample in SAMPLES:
        mine = windows["sample"] == sample
        axes.hist(condition[mine], edges, histtype="step", label=sample)
        lower = (windows["rank"] < windows["columns"])[mine].mean()
        figures = " | ".join(f"{value:.2g}" for value in np.quantile(condition[mine], (0.5, 0.9, 0.99)))
        print(f"| {sample} | {mine.sum()} | {lower:.1%} | {figures} |")
    axes.set(xscale="log", xlabel="condition number of S X, columns of length 1", ylabel="windows")
    axes.legend()
    save(figure, "conditions")


def draw_residuals(windows):
    figure, axes = plt.subplots(figsize=(7, 4))
    edges = np.logspace(0, 12, 25)
    place = np.digitize(windows["condition"], edges)
    print("\n| solver | largest residual ratio, condition below 1e4 | below 1e8 | all | no number |")
    print("|---|---:|---:|---:|---:|")
    for solver in SOLVERS:
        ratio = field(windows, solver)
        bins = [k for k in range(1, len(edges)) if (place == k).sum() > 5]
        worst = [np.nanmax(np.append(ratio[place == k], 0)) for k in bins]
        axes.plot(
            np.sqrt(edges[np.array(bins) - 1] * edges[bins]),
            np.maximum(worst, 1e-12),
            ".-",
            label=LABELS.get(solver, solver),
        )
        largest = [np.nanmax(ratio[windows["condition"] < most]) for most in (1e4, 1e8, np.inf)]
        cells = [
            LABELS.get(solver, solver),
            *(f"{value:.2g}" for value in largest),
            f"{(~np.isfinite(ratio)).mean():.1%}",
        ]
        print(f"| {' | '.join(cells)} |")
    axes.axhline(LAPACK_LIMIT, color="grey", linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="condition number", ylabel="largest residual ratio")
    axes.legend()
    save(figure, "residuals")


def draw_columns(columns):
    figure, axes = plt.subplots(figsize=(7, 4))
    left = np.maximum(columns["left"], 1e-18)
    edges = np.logspace(-9, 0, 37)
    place = np.digitize(left, edges)
    bins = np.array([k for k in range(1, len(edges)) if (place == k).sum() > 0])
    for name in ("hardly any limits", "limits in use"):
        worst = np.array([field(columns, name)[place == k].max() for k in bins])
        axes.plot(np.sqrt(edges[bins - 1] * edges[bins])[worst > 0], worst[worst > 0], ".-", label=name)
    axes.axvline(REMAINDER, color="grey", linestyle=":")
    axes.text(REMAINDER, 2e-7, " counts for half", rotation=90, va="bottom", ha="right", color="grey")
    axes.set(xscale="log", yscale="log", xlabel="what is left of a column, as a part of its length")
    axes.set(ylabel="largest overlap with the columns before it")
    axes.legend()
    save(figure, "columns")
    shares = [(columns["left"] < limit).mean() for limit in (1e-4, REMAINDER)]
    print(f"\n{len(columns)} columns: {shares[0]:.1%} below 1e-4, {shares[1]:.1%} below {REMAINDER:g}")


def print_limits(limits):
    print("\n| remainder | variation | error of the fits, geometric mean | columns below | largest overlap |")
    print("|---:|---:|---:|---:|---:|")
    settings = list(dict.fromkeys(zip(limits["remainder"], limits["variation"])))
    rows = {s: limits[(limits["remainder"] == s[0]) & (limits["variation"] == s[1])] for s in settings}
    for setting in settings:
        ratio = np.exp(np.mean(np.log(rows[setting]["error"] / rows[REMAINDER, VARIATION]["error"])))
        dropped, overlap = rows[setting]["dropped"].mean(), rows[setting]["overlap"].max()
        print(f"| {setting[0]:g} | {setting[1]:g} | {ratio:.4f} | {dropped:.1%} | {overlap:.2g} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/dev/tests/bench/stability")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "stability", help="folder of the tables")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    pairs = [ROOT / "samples" / name for s, r in SAMPLES.items() for name in (f"{s}.exr", f"{r}_ref.exr")]
    subprocess.run([options.program, options.out, *pairs], check=True)
    windows = table(options.out, "windows.csv")
    draw_conditions(windows)
    draw_residuals(windows)
    draw_columns(table(options.out, "columns.csv"))
    print_limits(table(options.out, "limits.csv"))


if __name__ == "__main__":
    main()
