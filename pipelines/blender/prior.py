"""Priors: the halves of a picture, denoised by Cycles' denoiser, as an input of the reconstruction."""

import numpy as np

from ..common import exr

SECONDS_OVER_DECISION = 1.3  # seconds of `add` over those of a round's decision (docs/lab/2026-11-28-adaptive-loop.md)
FEATURES = {"Denoising Albedo": "RGB", "Denoising Normal": "XYZ", "Denoising Depth": "Z"}


def add(merged, layer, session):
    """Adds the layers `Prior A`, `Prior B` and their mean `Prior` to a merged file.

    Prior A comes from half A of picture and features alone, and B from half B, so their noise is independent."""
    channels = exr.read(merged)
    attributes = {name: value for name, value in exr.metadata(merged).items() if isinstance(value, (str, int, float))}
    source, target = session.folder / "half.exr", session.folder / "denoised.exr"
    priors = {}
    for half in "AB":
        exr.write(source, _half(channels, layer, half), {f"cycles.{layer}.samples": "1"})
        session.request("denoise", source=str(source), target=str(target))
        denoised = exr.read(target)
        priors.update({f"{layer}.Prior {half}.{c}": denoised[f"{layer}.Combined.{c}"] for c in "RGB"})
        source.unlink()
        target.unlink()
    priors.update(
        {f"{layer}.Prior.{c}": (priors[f"{layer}.Prior A.{c}"] + priors[f"{layer}.Prior B.{c}"]) / 2 for c in "RGB"}
    )
    exr.write(merged, {**channels, **priors}, attributes, compression="none")  # as the file was


def _half(channels, layer, half):
    """The passes that Cycles' denoiser of files requires. It also requires motion vectors, which it uses in animations
    only."""
    picture = {c: channels[f"{layer}.Combined {half}.{c}"] for c in "RGB"} | {
        "A": np.ones_like(channels[f"{layer}.Combined.R"])
    }
    found = {f"{layer}.{name}.{c}": plane for name in ("Combined", "Noisy Image") for c, plane in picture.items()}
    found.update(
        {f"{layer}.{name}.{c}": channels[f"{layer}.{name} {half}.{c}"] for name, cs in FEATURES.items() for c in cs}
    )
    return found | {f"{layer}.Vector.{c}": np.zeros_like(picture["A"]) for c in "XYZW"}
