"""Table and plot of the bench's results."""

import math
import os
import platform

LABEL = {
    "uniform": "(a) uniform, polyrecon",
    "adaptive": "(b) adaptive loop",
    "cycles": "(c) Cycles adaptive, OIDN",
    "oidn": "(d) uniform, OIDN",
    "prior": "(e) loop with OIDN as prior",
    "uniform_prior": "(f) uniform with OIDN as prior",
}
COLOUR = {
    "uniform": "#4477aa",
    "adaptive": "#cc3311",
    "cycles": "#228833",
    "oidn": "#aa8800",
    "prior": "#aa3377",
    "uniform_prior": "#66ccee",
}
RATIOS = (
    ("adaptive", "uniform"),
    ("adaptive", "cycles"),
    ("prior", "uniform"),
    ("prior", "uniform_prior"),
    ("prior", "cycles"),
)
BEGIN, END = "<!-- bench: made by tests/bench/blender/bench.py -->", "<!-- end of bench -->"


def averaged(rows):
    """One row for each scene, budget and method: geometric mean of the draws' errors, mean of their seconds."""
    cells = {}
    for row in rows:
        cells.setdefault((row["scene"], row["budget"], row["method"]), []).append(row)
    return [
        dict(zip(("scene", "budget", "method"), cell))
        | {figure: _mean([row[figure] for row in draws]) for figure in ("relMSE", "trimmed")}
        | {"seconds": sum(r["seconds"] for r in draws) / len(draws)}
        for cell, draws in cells.items()
    ]


def _mean(errors):
    """Geometric. Arithmetic if the error is not above 0, after the reference's variance is subtracted (tiny frames)."""
    if len(errors) > 1 and min(errors) > 0:
        return math.exp(sum(map(math.log, errors)) / len(errors))
    return sum(errors) / len(errors)


def table(rows):
    """A Markdown table with a line for each scene and budget.

    A method's cell has the relMSE, the trimmed one without the 0.1 % worst pixels (single pixels where the reference
    itself has not converged can decide the first), and the seconds. The last columns are ratios of both figures."""
    rows = averaged(rows)
    methods = [method for method in LABEL if any(row["method"] == method for row in rows)]
    ratios = [pair for pair in RATIOS if set(pair) <= set(methods)]
    named = [LABEL[method] for method in methods] + [f"{LABEL[a][:3]} / {LABEL[b][:3]}" for a, b in ratios]
    lines = ["| scene | budget | " + " | ".join(named) + " |", "|---|---|" + "---|" * len(named)]
    for scene, budget in dict.fromkeys((row["scene"], row["budget"]) for row in rows):
        found = {row["method"]: row for row in rows if (row["scene"], row["budget"]) == (scene, budget)}
        cells = [_cell(found[m]) if m in found else "" for m in methods]
        cells += [_ratio(found, *pair) for pair in ratios]
        lines.append(f"| {scene} | {budget:g} s | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _ratio(found, above, below):
    if above not in found or below not in found:
        return ""
    return " / ".join(f"{found[above][figure] / found[below][figure]:.2f}" for figure in ("relMSE", "trimmed"))


def _cell(row):
    return f"{row['relMSE']:.5f} / {row['trimmed']:.5f} ({row['seconds']:.1f} s)"


def write(document, rows, options):
    """Puts the table between the marks of a page, and the plot next to the page."""
    text = document.read_text()
    head, _, rest = text.partition(BEGIN)
    _, mark, tail = rest.partition(END)
    if not mark:
        raise SystemExit(f"{document}: no '{BEGIN}' ... '{END}'")
    made = (
        f"{options.size}, references of {options.reference_spp} samples, {os.cpu_count()} cores ({platform.machine()})"
    )
    if options.draws > 1:
        made += f", geometric means of {options.draws} draws"
    clock = {"wall": "seconds", "cpu": "processor seconds"}[options.clock]
    picture = document.with_suffix(".svg")
    plot(rows, picture, clock)
    body = f"{made}; relMSE / trimmed ({clock}):\n\n{table(rows)}\n\n![Error against seconds]({picture.name})"
    document.write_text(f"{head}{BEGIN}\n\n{body}\n\n{END}{tail}")


def plot(rows, path, clock):
    """Draws trimmed relMSE against seconds, one panel for each scene."""
    import matplotlib

    rows = averaged(rows)
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "bench", "svg.fonttype": "none", "font.size": 8})
    import matplotlib.pyplot as plt
    from matplotlib.ticker import LogLocator, NullFormatter

    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    budgets = {scene: {row["budget"] for row in rows if row["scene"] == scene} for scene in scenes}
    scenes = [scene for scene in scenes if len(budgets[scene]) > 1] or scenes  # a single budget makes no curve
    figure, axes = plt.subplots(1, len(scenes), figsize=(2.6 * len(scenes), 2.8), squeeze=False, layout="constrained")
    for axis, scene in zip(axes[0], scenes):
        for method, label in LABEL.items():
            points = sorted((r["seconds"], r["trimmed"]) for r in rows if (r["scene"], r["method"]) == (scene, method))
            if points:
                axis.loglog(*zip(*points), "o-", color=COLOUR[method], label=label, markersize=3, linewidth=1.2)
        axis.set_title(scene)
        axis.set_xlabel(f"{clock}, all included")
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 3, 5)))  # labels of all digits run into each other
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.grid(True, which="both", linewidth=0.3)
    axes[0][0].set_ylabel("relMSE, trimmed")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0), ncol=len(LABEL))
    figure.savefig(path, metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)
