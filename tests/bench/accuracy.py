#!/usr/bin/env python3
"""Measures what every setting and every part of the method brings on the samples, in error and in time. Runs
`polyrecon sweep` on each sample, writes the tables of docs/results/accuracy.md, and writes the figures that
--time-budget and --target choose by into src/presets/preset_figures.cpp, which the next build compiles in. The
reports of the sweeps stay in out/accuracy/.

Build the release preset first; let nothing else run meanwhile. Under ten minutes on two cores.
"""

import argparse
import csv
import math
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = {"study": "study", "glass": "glass", "lighthouse": "lighthouse", "study_denoised": "study"}  # : reference
BUDGET_SETTINGS = (
    "draft, order 0",
    "draft",
    "draft, stages 2",
    "stages 1",
    "standard",
    "order 3",
    "best, coverage 2",
    "best",
)
# Each part of the method alone, and the setting of the sweep that takes it out.
PARTS = (
    ("weights and features from the other half", "weights from the same half"),
    ("half buffers of the file (else split from the mean)", "without half buffers"),
    ("shrinkage factors", "no shrinkage"),
    ("second stage", "stages 1"),
    ("coarser levels", "levels 1"),
    ("second stage and coarser levels", "one stage, one level"),
    ("guided windows", "no guided windows"),
    ("several bandwidths", "one bandwidth"),
    ("Taylor terms", "order 0"),
    ("patch weights", "no patch weights"),
    ("choice pixel by pixel (else by regions five times as wide)", "choice by wide regions"),
    ("orders averaged on a near tie (else rounding decides)", "order by least error alone"),
    ("finer centres where coverage is low", "coverage 0"),
    ("firefly handling", "no firefly removal"),
    ("variance floor", "no variance floor"),
    ("feature prefilter", "no feature prefilter"),
    ("noise bound", "no noise bound"),
    ("raising of undershoot", "no raising of undershoot"),
    ("totals restored", "totals not restored"),
    ("all features", "without features"),
    ("normal", "without normal"),
    ("albedo", "without albedo"),
    ("depth", "without depth"),
    ("visibility", "without visibility"),
    ("denoised layer of the file", "without prior"),
)
ALL_STEPS = "all steps"  # the setting of the sweep in which no step is left out
NUMBERS = ("levels 2", "levels 4", "stride ", "radius ", "order ", "coverage 6", "patch ", "four band", "one guided")
PAYS = 1.003  # a part whose removal raises the error by less than 0.3 % does not pay for itself


def sweep(options, sample):
    """{setting: {column: text}} of one sample; the noisy input is 'noisy'."""
    table = options.out / f"{sample}.csv"
    if options.only is None or sample in options.only:
        command = [options.polyrecon, "sweep", "-i", ROOT / "samples" / f"{sample}_16.exr", "--reference"]
        command += [
            ROOT / "samples" / f"{SAMPLES[sample]}_ref.exr",
            "-o",
            options.out / f"{sample}.html",
            "--overwrite",
        ]
        groups = (
            "quality,presets,stages,levels,stride,radius,order,coverage,patch,bandwidths,features,halves,prior,ablation"
        )
        command += ["--csv", table, "--vary", groups, "--quiet"]
        subprocess.run([str(word) for word in command], check=True)
    with open(table, newline="", encoding="utf-8") as file:
        return {row["setting"]: row for row in csv.DictReader(file)}


def ratio(found, setting, column):
    """Over standard; None where the sample has no such setting."""
    if setting not in found:
        return None
    return float(found[setting][column]) / float(found["standard"][column])


def mean(ratios):
    """Geometric."""
    known = [r for r in ratios if r is not None]
    return math.exp(sum(map(math.log, known)) / len(known)) if known else None


def cell(value, digits=3):
    return "" if value is None else f"{value:.{digits}f}"


def table(head, rows):
    align = ["---"] + ["---:"] * (len(head) - 1)
    lines = [head, align, *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def budget_table(found):
    head = ["settings"] + [f"{s}: s" for s in found] + [f"{s}: relMSE" for s in found] + ["time", "error"]
    rows = []
    for name in BUDGET_SETTINGS:
        rows.append(
            [name]
            + [f"{float(f[name]['seconds']):.2f}" for f in found.values()]
            + [f"{float(f[name]['relMSE']):.5f}" for f in found.values()]
            + [
                cell(mean([ratio(f, name, c) for f in found.values()]), 2 + (c == "relMSE"))
                for c in ("seconds", "relMSE")
            ]
        )
    noisy = [f"{float(f['noisy']['relMSE']):.5f}" for f in found.values()]
    rows.append(["noisy input"] + [""] * len(found) + noisy + ["", ""])
    return table(head, rows)


def ratios_table(found, entries, verdict):
    """entries: (what stands in the first column, setting)."""
    head = ["without" if verdict else "setting"] + [f"{s}: error" for s in found] + ["error", "time"]
    rows = []
    for label, setting in entries:
        errors = [ratio(f, setting, "relMSE") for f in found.values()]
        error, seconds = mean(errors), mean([ratio(f, setting, "seconds") for f in found.values()])
        if error is None:
            raise SystemExit(f"no sweep has the setting '{setting}'")
        row = [label] + [cell(e) for e in errors] + [cell(error), cell(seconds, 2)]
        rows.append([*row, "" if error >= PAYS else "does not pay"] if verdict else row)
    return table(head + [""] * verdict, rows)


def steps_table(found):
    """--steps auto against all."""
    rows = []
    for sample, f in found.items():
        back = [1 / ratio(f, ALL_STEPS, column) for column in ("seconds", "relMSE")]
        rows.append([sample, cell(back[0], 2), cell(back[1], 4)])
    return table(["sample", "time, auto / all", "error, auto / all"], rows)


def write_between(path, name, text, script="accuracy.py"):
    """Replaces what stands between the marks of that name."""
    begin, end = f"<!-- {name}: made by tests/bench/{script} -->", f"<!-- end of {name} -->"
    before, rest = path.read_text(encoding="utf-8").split(begin)
    path.write_text(f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")


def write_tables(document, found):
    numbers = [(s, s) for s in found["study"] if s.startswith(NUMBERS) and s != "order 0"]
    write_between(document, "budget", budget_table(found))
    write_between(document, "parts", ratios_table(found, PARTS, True))
    write_between(document, "numbers", ratios_table(found, numbers, False))
    write_between(document, "steps", steps_table(found))


def write_figures(path, found):
    lines = []
    for name in BUDGET_SETTINGS:
        figures = [mean([ratio(f, name, column) for f in found.values()]) for column in ("seconds", "relMSE")]
        lines.append(f"      {{{figures[0]:.3g}, {figures[1]:.4g}}},  // {name}")
    source = path.read_text(encoding="utf-8")
    before, rest = source.split("figures{{\n")
    # clang-format aligns the comments.
    path.write_text(before + "figures{{\n" + "\n".join(lines) + "\n  }};" + rest.split("  }};")[1], encoding="utf-8")
    subprocess.run(["clang-format", "-i", str(path)], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--polyrecon", default=ROOT / "build" / "release" / "src" / "polyrecon")
    parser.add_argument(
        "--out", type=pathlib.Path, default=ROOT / "out" / "accuracy", help="folder for reports and CSV"
    )
    parser.add_argument("--only", choices=SAMPLES, nargs="*", help="sweep these; the others' CSV must be there")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    found = {sample: sweep(options, sample) for sample in SAMPLES}
    write_tables(ROOT / "docs" / "results" / "accuracy.md", found)
    write_figures(ROOT / "src" / "presets" / "preset_figures.cpp", found)


if __name__ == "__main__":
    main()
