"""The functions of the package."""

from __future__ import annotations

import os
import pathlib
import re
import tempfile
from collections.abc import Mapping, Sequence
from typing import Union

import numpy as np
import numpy.typing as npt

from ._arrays import USAGE, Images, Result, as_image, without_channel
from ._library import Error, Filter, Progress

Path = Union[str, "os.PathLike[str]"]
Array = npt.ArrayLike
Halves = Sequence[Array]
PassArray = Union[Array, Mapping[str, Array]]
PassHalves = Union[Halves, Mapping[str, Halves]]


def denoise(
    beauty: Array | Mapping[str, Array],
    albedo: Array | None = None,
    normal: Array | None = None,
    depth: Array | None = None,
    variance: PassArray | None = None,
    halves: PassHalves | None = None,
    prior: Array | str | None = None,
    *,
    visibility: Array | None = None,
    alpha: Array | None = None,
    aovs: Mapping[str, Array] | None = None,
    sample_count: Array | float | None = None,
    quality: str = "standard",
    denoise_alpha: bool = False,
    wrap: bool = False,
    budget: float | None = None,
    target: float | None = None,
    stages: int | None = None,
    order: int | None = None,
    threads: int = 0,
    max_memory: int | None = None,
    oidn: Path | None = None,
    oidn_device: str | None = None,
    progress: Progress | None = None,
) -> Result:
    """Denoises a frame.

    beauty: (height, width, 3), linear radiance, the mean of each pixel's samples; or all passes by name, as `read`
        returns them.
    albedo, normal: (height, width, 3). depth, visibility: (height, width); any unit. They guide the reconstruction and
        may be noisy.
    variance: variance of the mean of each pixel's samples (not of one sample), the shape of the beauty; or by the names
        of passes, {"beauty": ..., "albedo": ...}. Results are better with it.
    halves: (A, B), the means over two independent halves of the samples; or by the names of passes.
    prior: (height, width, 3), a picture by another denoiser, or "oidn": Open Image Denoise makes one in the process.
    alpha: (height, width), 0 to 1. It tells what was not rendered; denoise_alpha: denoise it too.
    aovs: further colour layers by name, (height, width, 3), that add up to the beauty; denoised by the same windows.
    sample_count: samples per pixel, a number or (height, width).
    quality: "draft", "standard" or "best".
    wrap: a panorama, whose last column is next to the first.
    budget, target: also make a sample map: mean extra samples per pixel, or the mean relative error to reach.
    stages, order: in place of those of the quality; 1 to 4 and 0 to 4.
    threads: 0 for all processors. max_memory: bytes. Neither changes a bit of the result.
    oidn, oidn_device: its library, and the device it runs on ("cpu", "cuda", ...).
    progress: called with the name of a phase and the share of it that is done; returns False to stop the work, which
        raises `StoppedError`. It is called from another thread.
    """
    given = isinstance(beauty, Mapping)
    images: dict[str, Array] = dict(beauty) if isinstance(beauty, Mapping) else {"beauty": beauty}
    named = {"albedo": albedo, "normal": normal, "depth": depth, "visibility": visibility, "alpha": alpha}
    images.update({name: array for name, array in named.items() if array is not None})
    if given and "beauty" not in images:
        raise Error("there is no image 'beauty'", USAGE)
    for name, array in _by_pass(variance).items():
        images[f"{name} variance"] = array
    for name, pair in _by_pass(halves).items():
        try:
            images[f"{name} A"], images[f"{name} B"] = pair
        except (TypeError, ValueError):
            raise Error(f"halves of '{name}': (A, B), a pair of arrays, are needed", USAGE) from None
    if not isinstance(aovs or {}, Mapping):
        raise Error("aovs: arrays by name are needed, {'Diffuse': ...}", USAGE)
    for name, array in (aovs or {}).items():
        images[f"aov {name}"] = array
    work = Filter("denoise")
    if isinstance(prior, str):
        work.set("prior", prior)
    elif prior is not None:
        images["prior"] = prior
    if sample_count is not None:
        if np.ndim(sample_count) == 0:
            work.set("samples", sample_count)
        else:
            images["sample-count"] = sample_count  # type: ignore[assignment]
    for name, array in images.items():
        work.set_image(name, as_image(name, array))
    for name, value in {
        "quality": quality, "alpha": denoise_alpha, "wrap": wrap, "budget": budget, "target": target,
        "stages": stages, "order": order, "threads": threads, "max memory": max_memory, "oidn": oidn,
        "oidn device": oidn_device,
    }.items():  # fmt: skip
        work.set(name, value)
    work.execute(progress)
    return _result(work)


def _by_pass(value):  # type: ignore[no-untyped-def]
    """The arguments by the names of passes; an argument without names is the beauty's."""
    if value is None:
        return {}
    return value if isinstance(value, Mapping) else {"beauty": value}


def _result(work: Filter) -> Result:
    made = {name: without_channel(image) for name, image in work.images().items()}
    aovs = {name[len("aov ") :]: made.pop(name) for name in list(made) if name.startswith("aov ")}
    return Result(
        image=made["result"],
        aovs=aovs,
        alpha=made.get("alpha"),
        samples=made.get("samples"),
        report=work.report(),
        **{name: made[name] for name in ("relmse", "relvariance", "relnoise", "mse", "order")},
    )


def merge(
    renders: Sequence[Path | Array | Mapping[str, Array]],
    output: Path | None = None,
    *,
    samples: float | None = None,
    half_b: Sequence[Path] = (),
) -> Images:
    """Merges independent renders of one frame into mean, variance and halves: what `denoise` does best with.

    renders: EXR files; or arrays, a beauty (height, width, 3) each or passes by name, of the same number of samples.
        Subsets of one sample sequence, or renders with different random seeds.
    output: EXR file to write; without it the merged passes are only returned.
    samples: samples per pixel of each render, where the files do not say it, or say it wrong.
    half_b: files of half B; all of `renders` are then half A.
    """
    is_image = isinstance(renders, np.ndarray) and renders.ndim < 4
    if is_image or isinstance(renders, (str, bytes, os.PathLike, Mapping)):
        raise Error("renders: several are needed, [first, second, ...]", USAGE)
    with tempfile.TemporaryDirectory() as folder:
        work = Filter("merge")
        for index, render in enumerate(renders):
            work.set("input", _as_file(render, pathlib.Path(folder) / f"{index}.exr"))
        work.set("half B", list(half_b))
        target = pathlib.Path(folder) / "merged.exr" if output is None else output
        work.set("output", target)
        work.set("samples", samples)
        try:
            work.execute()
        except Error as error:
            message = re.sub(rf"{re.escape(folder)}/(\d+)\.exr", r"renders[\1]", str(error))
            raise Error(message, error.exit_code) from None
        merged = read(target)
        merged.report["merge"] = work.report()
        return merged


def _as_file(render: Path | Array | Mapping[str, Array], path: pathlib.Path) -> Path:
    if isinstance(render, (str, os.PathLike)):
        return render
    write(path, render if isinstance(render, Mapping) else {"beauty": render})
    return path


def sample_map(
    result: Result,
    budget: float | None = None,
    target: float | None = None,
    *,
    sample_count: Array | float | None = None,
    cost: Array | None = None,
    max_samples: float | None = None,
) -> np.ndarray:
    """Says where a renderer should take its next samples: (height, width), extra samples of each pixel, not rounded.

    result: of `denoise`.
    budget: mean extra samples per pixel; or target: the mean relative error to reach with the fewest.
    sample_count: samples per pixel so far, a number or (height, width); unknown, 8 are assumed.
    cost: (height, width), seconds per sample up to a common factor; the budget then counts samples of mean cost.
    max_samples: most extra samples of a pixel; 1024 unless given.
    """
    if not isinstance(result, Result):
        raise Error("sample_map takes the result of denoise", USAGE)
    work = Filter("sample map")
    for name in ("relmse", "relvariance", "relnoise"):
        work.set_image(name, as_image(name, getattr(result, name)))
    if sample_count is not None and np.ndim(sample_count) == 0:
        work.set("samples", sample_count)
    elif sample_count is not None:
        work.set_image("sample-count", as_image("sample-count", sample_count))
    if cost is not None:
        work.set_image("cost", as_image("cost", cost))
    for name, value in {"budget": budget, "target": target, "max samples": max_samples}.items():
        work.set(name, value)
    work.execute()
    return without_channel(work.image("samples"))


def read(
    path: Path,
    *,
    aovs: Sequence[str] = (),
    roles: Mapping[str, str] | None = None,
    view_layer: str | None = None,
    view: str | None = None,
    samples: float | None = None,
) -> Images:
    """Reads the passes of a render that `denoise` uses, by the names of their roles.

    path: an EXR file of a renderer that is known (docs/reference/formats.md).
    aovs: further colour layers to read, by the names that `polyrecon inspect` shows.
    roles: layers whose role the names do not tell: {"albedo": "ViewLayer.MyAlbedo"}.
    view_layer, view: which picture of the file, if it has several; the first without them.
    samples: samples per pixel, where the file does not say it.
    """
    if path is None:
        raise Error("read: the path of a file is needed", USAGE)
    work = Filter("read")
    work.set("input", path)
    work.set("aov", list(aovs))
    work.set("map", [f"{role}={layer}" for role, layer in (roles or {}).items()])
    for name, value in {"view layer": view_layer, "view": view, "samples": samples}.items():
        work.set(name, value)
    work.execute()
    images = {name: without_channel(image) for name, image in work.images().items()}
    return Images(images, report=work.report())


def write(
    path: Path,
    images: Result | Array | Mapping[str, Array],
    *,
    like: Path | None = None,
    view_layer: str | None = None,
    view: str | None = None,
    keep_noisy: bool = False,
) -> list[str]:
    """Writes an EXR file; it takes its name only when it is whole. Returns notes on what was unusual.

    images: a `Result`; an array, which is written as the beauty; or arrays by name, of up to 4 channels.
    like: the render that the result was made of. The file is then a copy of it with the picture replaced: all other
        layers, names and metadata stay. Images are then a `Result`, an array or "result", "alpha", "aov LAYER" by name.
    keep_noisy: keep the layers that are replaced as `LAYER Noisy`.
    """
    work = Filter("write")
    work.set("output", path)
    for name, value in {"like": like, "view layer": view_layer, "view": view, "keep noisy": keep_noisy}.items():
        work.set(name, value)
    for name, array in _to_write(images, like is not None).items():
        work.set_image(name, as_image(name, array))
    work.execute()
    return [str(note) for note in work.report()["notes"]]


def _to_write(images: Result | Array | Mapping[str, Array], is_copy: bool) -> dict[str, Array]:
    if isinstance(images, Mapping):
        return dict(images)
    if not isinstance(images, Result):
        return {"result" if is_copy else "beauty": images}
    layers: dict[str, Array] = {"result" if is_copy else "beauty": images.image}
    layers.update({f"aov {name}" if is_copy else name: array for name, array in images.aovs.items()})
    if images.alpha is not None:
        layers["alpha"] = images.alpha
    if not is_copy:
        maps = {
            name: getattr(images, name) for name in ("relmse", "relvariance", "relnoise", "mse", "order", "samples")
        }
        layers.update({name: array for name, array in maps.items() if array is not None})
    return layers
