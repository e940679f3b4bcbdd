"""Mitsuba 3 renders, polyrecon denoises: denoise_mitsuba.py [--samples N] [--size PIXELS] [--reference N]

    pip install mitsuba

The frame is rendered eight times with different random seeds. Their merge knows the noise of every pixel, which one
render does not, and costs no more than a render of the sum of the samples.
"""

import argparse

import mitsuba as mi
import numpy as np
import polyrecon

RENDERS = 8
PASSES = {"albedo": slice(3, 6), "normal": slice(6, 9), "depth": slice(9, 10)}  # channels behind the colour


def scene(size):
    """A Cornell box with a glossy sphere. `hide_emitters` is off, so the lamp is part of the picture."""
    description = mi.cornell_box()
    film = description["sensor"]["film"]
    film.update(width=size, height=size, pixel_format="rgb", rfilter={"type": "box"})
    description["integrator"] = {
        "type": "aov",
        "aovs": "albedo:albedo,normal:sh_normal,depth:depth",
        "path": {"type": "path", "max_depth": 8},
    }
    return mi.load_dict(description)


def render(frame, samples, seed):
    """The passes of a render as arrays, by the names that polyrecon knows."""
    pixels = np.array(mi.render(frame, spp=samples, seed=seed))
    return {"beauty": pixels[:, :, :3], **{name: pixels[:, :, channels] for name, channels in PASSES.items()}}


def relative_error(image, reference):
    """relMSE: mean of (x - r)^2 / (r^2 + 0.01)."""
    return float(np.mean((image - reference) ** 2 / (reference**2 + 0.01)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=32, help="per pixel, of all renders together")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--reference", type=int, default=2048, help="samples per pixel of the picture to compare with")
    options = parser.parse_args()
    mi.set_variant("scalar_rgb")
    frame = scene(options.size)
    renders = [render(frame, options.samples // RENDERS, seed) for seed in range(RENDERS)]
    merged = polyrecon.merge(renders, samples=options.samples // RENDERS)
    clean = polyrecon.denoise(merged)
    polyrecon.write("clean.exr", clean)

    reference = render(frame, options.reference, RENDERS)["beauty"]
    print(f"relMSE of the render:     {relative_error(merged['beauty'], reference):.5f}")
    print(f"relMSE when denoised:     {relative_error(clean.image, reference):.5f}")
    print(f"estimated by polyrecon:   {clean.relmse.mean():.5f}")


if __name__ == "__main__":
    main()
