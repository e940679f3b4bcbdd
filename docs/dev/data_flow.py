#!/usr/bin/env python3
"""Prints docs/dev/data_flow.svg, the figure of docs/dev/architecture.md."""

WIDTH, BOX_WIDTH, BOX_HEIGHT = 960, 200, 62
LEFT, TOP, COLUMN, ROW = 110, 64, 280, 132  # of the first box; distances of boxes

# Phase, its steps as (function, folder), and the types that go to the next phase.
PHASES = [
    ("read", [("read_frame", "src/io"), ("wrap", "src/core; panoramas only")], "Frame"),
    (
        "survey",
        [
            ("rendered_mask, hide_void", "src/core; void pixels"),
            ("noise_variance", "src/noise"),
            ("choose_features", "src/features"),
        ],
        "Frame, NoiseVariance, Preparation",
    ),
    (
        "prepare",
        [
            ("prepare", "src/features"),
            ("noise_bound", "src/blend"),
        ],
        "HalfPair",
    ),
    (
        "prepare",
        [
            ("remove_outliers", "src/outliers"),
            ("floor_variance", "src/noise"),
        ],
        "HalfPair",
    ),
    ("join", [("join_neighbours", "src/temporal")], "HalfPair"),
    (
        "prior",
        [("denoise_frame", "src/denoisers; --prior oidn"), ("make_validation", "src/pipeline; a prior in halves")],
        "HalfPair, ReadyPrior",
    ),
    (
        "fit",
        [("fit_and_blend", "src/regression, src/blend"), ("select", "src/blend"), ("add_coarse", "src/blend")],
        "Candidate",
    ),
    ("finish", [("empty_void", "src/core"), ("make_error_map", "src/maps")], "Candidate, ErrorMap"),
    (
        "finish",
        [
            ("use_prior", "src/pipeline, src/prior"),
            ("raise_undershoot", "src/blend; mean of both halves"),
            ("restore_energy", "src/outliers"),
        ],
        "Result",
    ),
    (
        "write",
        [("unwrapped", "src/core; panoramas only"), ("make_sample_map", "src/maps"), ("write_result", "src/io")],
        None,
    ),
]

# Labels of the frames around phases.
FRAMES = {
    "survey": "survey_frame, src/pipeline; inspect runs it too",
    "fit": "repeated for each level and stage: run_stage, src/pipeline",
}

# Inputs of a phase from the side.
INPUTS = {"join": ("Neighbour", "frames before and after, by the same steps from survey to prepare: prepare_neighbour")}

STYLE = """
  .card { fill: #ffffff; stroke: #d0d7de; }
  .box { fill: #eef4fb; stroke: #57789c; }
  .line { fill: none; stroke: #57606a; stroke-width: 1.5; }
  .frame { fill: none; stroke: #57606a; stroke-dasharray: 6 4; }
  .head { fill: #57606a; }
  text { font-family: sans-serif; font-size: 15px; fill: #1f2328; }
  .folder { font-size: 12px; fill: #57606a; }
  .type { font-style: italic; }
  .phase { font-weight: bold; }
  @media (prefers-color-scheme: dark) {
    .card { fill: #0d1117; stroke: #3d444d; }
    .box { fill: #1b2a3b; stroke: #7aa2cf; }
    .line, .frame { stroke: #9198a1; }
    .head { fill: #9198a1; }
    text { fill: #e6edf3; }
    .folder { fill: #a8b1bb; }
  }
"""


def box(x, y, step):
    function, folder = step
    middle = x + BOX_WIDTH / 2
    return [
        f'<rect class="box" x="{x}" y="{y}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="6"/>',
        f'<text x="{middle}" y="{y + 27}" text-anchor="middle">{function}</text>',
        f'<text class="folder" x="{middle}" y="{y + 47}" text-anchor="middle">{folder}</text>',
    ]


def arrow(path):
    return [f'<path class="line" d="{path}" marker-end="url(#head)"/>']


def row(number, phase, steps, result, is_first_of_phase):
    y = TOP + number * ROW
    middle = y + BOX_HEIGHT / 2
    lines = [f'<text class="phase" x="16" y="{middle + 5}">{phase}</text>'] if is_first_of_phase else []
    for k, step in enumerate(steps):
        x = LEFT + k * COLUMN
        lines += box(x, y, step)
        if k + 1 < len(steps):
            lines += arrow(f"M {x + BOX_WIDTH} {middle} H {x + COLUMN - 7}")
    if result:
        x = LEFT + (len(steps) - 1) * COLUMN + BOX_WIDTH / 2
        turn = y + BOX_HEIGHT + 40
        end = LEFT + BOX_WIDTH / 2
        lines += arrow(f"M {x} {y + BOX_HEIGHT} V {turn} H {end} V {y + ROW - 7}")
        lines.append(f'<text class="type" x="{end + 12}" y="{turn - 7}">{result}</text>')
    return lines


def frame(number, steps, label):
    """A frame around the boxes of a phase."""
    y = TOP + number * ROW
    left, right = LEFT - 16, LEFT + (len(steps) - 1) * COLUMN + BOX_WIDTH + 16
    return [
        f'<rect class="frame" x="{left}" y="{y - 14}" width="{right - left}" height="{BOX_HEIGHT + 28}" rx="8"/>',
        f'<text class="folder" x="{right}" y="{y - 22}" text-anchor="end">{label}</text>',
    ]


def side_input(number, steps, kind, label):
    """An arrow from the right into the last box of a phase."""
    x = LEFT + (len(steps) - 1) * COLUMN + BOX_WIDTH
    middle = TOP + number * ROW + BOX_HEIGHT / 2
    return [
        *arrow(f"M {x + 480} {middle} H {x + 7}"),
        f'<text class="type" x="{x + 24}" y="{middle - 8}">{kind}</text>',
        f'<text class="folder" x="{x + 24}" y="{middle + 20}">{label}</text>',
    ]


def draw():
    height = TOP + len(PHASES) * ROW - 36
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
        'role="img" aria-labelledby="title">',
        '<title id="title">How data flows through polyrecon denoise, from the file to the result</title>',
        f"<style>{STYLE}</style>",
        '<defs><marker id="head" markerWidth="9" markerHeight="9" refX="2" refY="4.5" orient="auto" '
        'markerUnits="userSpaceOnUse"><path class="head" d="M 0 0 L 9 4.5 L 0 9 z"/></marker></defs>',
        f'<rect class="card" x="0.5" y="0.5" width="{WIDTH - 1}" height="{height - 1}" rx="8"/>',
        f'<text class="type" x="{LEFT}" y="36">EXR file</text>',
        *arrow(f"M {LEFT + 66} 31 H {LEFT + BOX_WIDTH / 2} V {TOP - 7}"),
    ]
    previous = None
    for number, (phase, steps, result) in enumerate(PHASES):
        lines += row(number, phase, steps, result, phase != previous)
        if phase in FRAMES:
            lines += frame(number, steps, FRAMES[phase])
        if phase in INPUTS:
            lines += side_input(number, steps, *INPUTS[phase])
        previous = phase
    return "\n".join([*lines, "</svg>"])


if __name__ == "__main__":
    print(draw())
