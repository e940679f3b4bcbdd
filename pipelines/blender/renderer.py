"""Blender's Cycles as a Renderer of the adaptive loop."""

import concurrent.futures
import pathlib
import time

import numpy as np

from ..common import exr
from ..common.errors import DriverError, ExitCode
from ..common.outputs import COMPRESSIONS
from ..common.scene_inputs import SceneInputs
from ..loop.pass_list import masked_passes, rectangular_passes
from ..loop.renderer import RENDER_SECONDS, SAMPLE_COUNT, Audit, Renderer, Switch
from . import masks
from .session import BlenderSession

PART_LAYERS = {
    "Combined",
    "Denoising Albedo",
    "Denoising Specular Albedo",  # this and the next since 5.2
    "Denoising Roughness",
    "Denoising Normal",
    "Denoising Depth",
    "Shadow",
    "Ambient Occlusion",
    "AO",
}
VECTORS = "Vector"  # The layer of the motion vectors, which the first part alone has
CRYPTOMATTE = "cryptomatte/"  # Beginning of the attributes by which compositors find a Cryptomatte and its names
RENDER_TIME = "Render Time"  # Cycles' pass: milliseconds of a thread for all samples of a pixel
OVERHEAD_SECONDS = 0.045  # fixed seconds of a pass, until they are measured

# The fixed costs of a masked pass, and of each pixel of its box, in samples of a pixel outside the mask
# (docs/lab/2026-11-27-loop-seconds.md).
MASKED_PASS, MASKED_PIXEL = 100_000, 2.5


class BlenderRenderer(Renderer):
    """Renders the frames of a .blend file.

    method       The way of extra samples: 'osl' (a camera with a mask, Blender 5 or later), 'regions' (rectangles), or
                 'auto'.
    visibility   The pass for that feature: 'shadow', 'ambient-occlusion' or None.
    view_layer   The name of the view layer; None: the first that is switched on.
    device       'cpu', 'gpu', or 'auto': a graphics card if the scene renders on the GPU and there is one.
    own_passes   The samples of passes that the file has switched on and only the user needs: 'first', those of the
                 first part, or 'full', the scene's, in a render of their own at the end."""

    def __init__(
        self,
        scene,
        blender=None,
        method="auto",
        visibility=None,
        timeout=3600.0,
        view_layer=None,
        device="auto",
        own_passes="first",
    ):
        self.scene = pathlib.Path(scene).absolute()
        self.method = method
        self.visibility = visibility
        self.view_layer = view_layer
        self.device = device
        self.completes = own_passes == "full"
        self.session = BlenderSession(blender, timeout)
        self.inputs = SceneInputs()
        self.overhead_seconds = OVERHEAD_SECONDS
        self.seconds_per_sample = 0.0

    def begin(self, frame):
        self.frame = frame
        self.attributes = {}  # Of the user's passes
        self._open()
        self.input_digests = self.inputs.begin_frame(self.opened["files"]["used"])
        self.name = f"Blender {self.opened['version']}"
        if self.method == "osl" and not self.masked:
            raise DriverError(ExitCode.USAGE, f"--method osl: {self.opened['no_mask_camera']}")
        return self._audit()

    @property
    def masked(self):
        return not self.opened["no_mask_camera"]

    @property
    def shape(self):
        return self.opened["height"], self.opened["width"]

    def _open(self):
        is_new, begin = not self.session.running, time.time_ns()
        self.opened = self.session.request(
            "open",
            path=str(self.scene),
            frame=self.frame,
            visibility=self.visibility,
            view_layer=self.view_layer,
            device=self.device,
            mask_camera=self.method != "regions",
            cache_folder=None if self.session.not_confined else str(self.session.new_folder()),
            shot=self.shot,
        )
        if is_new:
            self.inputs.opened(self.opened["files"]["opened"], begin)

    def _audit(self):
        found = self.opened
        passes = {"Combined": "the picture", "Denoising Albedo, Normal, Depth": "features"}
        if self.visibility:
            passes[self.visibility] = "feature: visibility"
        if self.shot:
            blur = " without motion blur, at one sample" if found["motion_blur"] else ""
            passes[VECTORS] = f"motion to the frames before and after; rendered once{blur}"
        if found["user_passes"]:
            when = f"at the end, {found['samples']} samples" if self.completes else "in the first part"
            passes[", ".join(found["user_passes"])] = f"switched on in the file; rendered once, {when}"
        effects = (f"{name}: {_effect_text(value)}" for name, value in found["effects"].items())
        notes = []
        if found["effects"]["scripted drivers"]:
            notes.append(
                "Python drivers of the file are not run; the properties that they drive keep their saved values"
            )
        if found["path_guiding"]:
            notes.append("path guiding learns anew in every render pass, so it helps less than in one long render")
        if self.device == "auto" and found["scene_device"] == "GPU" and found["device"] == "CPU":
            notes.append("the scene renders on the GPU, but Cycles finds no graphics card: the processor renders")
        if self.session.not_confined:
            notes.append(f"Blender can write where the file says: {self.session.not_confined}")
        method = "masks by a camera shader" if self.masked else f"rectangles, because {found['no_mask_camera']}"
        switches = [Switch(**switch) for switch in found["switches"]]
        return Audit(
            width=found["width"],
            height=found["height"],
            beauty=f"{found['view_layer']}.Combined",
            switches=switches,
            passes=passes,
            notes=notes,
            details=[f"device: {found['device']}", "effects: " + ", ".join(effects)],
            method=method,
            inputs=self.input_digests,
            features=["albedo", "normal", "depth", *(["visibility"] if self.visibility else [])],
            working=[f"{found['view_layer']}.{name}" for name in self._working_layers()],
            float_colours=found["output"]["float"],
            compression=found["output"]["compression"] if found["output"]["compression"] in COMPRESSIONS else "zip",
        )

    def _working_layers(self):
        """The layers of the parts that the file does not request. The first part alone knows a sample count of its own,
        which says nothing about the frame."""
        wanted = set()
        if self.opened["denoising_data"]:
            wanted |= {name for name in PART_LAYERS if name.startswith("Denoising")}
        if "use_pass_shadow" in self.opened["user_passes"]:
            wanted.add("Shadow")
        if "use_pass_ambient_occlusion" in self.opened["user_passes"]:
            wanted |= {"Ambient Occlusion", "AO"}
        if self.shot and "use_pass_vector" not in self.opened["user_passes"]:
            return sorted((PART_LAYERS - {"Combined"} - wanted) | {"Debug Sample Count", VECTORS})
        return sorted((PART_LAYERS - {"Combined"} - wanted) | {"Debug Sample Count"})

    def uniform(self, first, samples, target):
        user_passes = first == 0 and bool(self.opened["user_passes"])
        vectors = first == 0 and self.shot
        with_picture = vectors and not self.opened["motion_blur"]
        channels, seconds = self._render(first=first, samples=samples, user_passes=user_passes, vectors=with_picture)
        counts = np.full(self.shape, float(samples))
        self.seconds_per_sample = max(seconds - self.overhead_seconds, 0) / counts.sum()
        if vectors and not with_picture:
            still, _ = self._render_once(first=first, samples=1, vectors=True)
            channels.update({name: values for name, values in still.items() if _layer_of(name) == VECTORS})
        self._write(target, channels, counts, keep_all=user_passes)

    def extra(self, first, counts, target):
        samples = int(counts.max())
        if samples == counts.min():
            self._write(target, self._render(first=first, samples=samples)[0], counts)
            return
        sums, taken = {}, np.zeros(counts.shape)
        if self.masked:
            passes = masked_passes(counts, MASKED_PASS, MASKED_PIXEL)
        else:
            passes = rectangular_passes(counts, self._overhead_samples())
        for render_pass, channels in self._render_ahead(first, passes):
            x0, y0, x1, y1 = render_pass.box
            inside = render_pass.inside
            for name, values in channels.items():
                whole = sums.setdefault(name, np.zeros(counts.shape))
                weight = 1 if _is_time(name) else render_pass.samples
                np.add(whole[y0:y1, x0:x1], weight * values, out=whole[y0:y1, x0:x1], where=inside)
            taken[y0:y1, x0:x1] += render_pass.samples * inside
        means = {name: whole if _is_time(name) else whole / np.maximum(taken, 1) for name, whole in sums.items()}
        self._write(target, means, taken)

    def add_own_passes(self, merged):
        if not self.completes or not self.opened["user_passes"]:
            return
        # One sequence, of whatever length: there is no other part that its samples must not repeat.
        channels, _ = self._render_once(first=0, samples=self.opened["samples"], user_passes=True)
        self.inputs.check()
        own = {name: values for name, values in channels.items() if not _is_time(name) and not self._serves_loop(name)}
        exr.write(merged, {**exr.read(merged), **own}, self.attributes)

    def _serves_loop(self, name):
        return _layer_of(name) in {*PART_LAYERS, VECTORS, "Debug Sample Count"}

    def _render_ahead(self, first, passes):
        """Yields each pass with its channels. While the caller processes one, the next is rendered. An error or an
        interrupt ends Blender."""
        renderer = concurrent.futures.ThreadPoolExecutor(1)
        try:
            previous = None
            for render_pass in [*passes, None]:
                rendering = render_pass and renderer.submit(self._render_pass, first, render_pass)
                if previous:
                    yield previous[0], previous[1].result()
                previous = render_pass, rendering
        except BaseException:
            with self.session.halt():
                renderer.shutdown(cancel_futures=True)
            raise
        renderer.shutdown()

    def _render_pass(self, first, render_pass):
        samples, inside = render_pass.samples, render_pass.inside
        if inside.shape == self.shape and inside.all():  # Every pixel takes the lowest count.
            return self._render(first=first + render_pass.skip, samples=samples)[0]
        job = {"first": first + render_pass.skip, "samples": samples, "crop": render_pass.box}
        if not self.masked:
            channels, seconds = self._render(**job)
            self.overhead_seconds = max(0.001, seconds - self.seconds_per_sample * samples * inside.size)
            return channels
        mask = masks.write(self.session.folder, render_pass, self.opened["filter_overhang"], self.shape)
        channels, _ = self._render(**job, mask=mask)
        pathlib.Path(mask["path"]).unlink()
        return channels

    def _overhead_samples(self):
        """The fixed cost of a pass, in samples of a pixel."""
        return self.overhead_seconds / self.seconds_per_sample if self.seconds_per_sample > 0 else float("inf")

    def close(self):
        self.session.close()

    def _render(self, first, samples, user_passes=False, vectors=False, **job):
        """Renders a pass; returns (channels, seconds).

        Samples of several sequences take a pass for each sequence, and the result is their mean. The user's passes and
        the motion vectors then come from the first one."""
        channels, seconds, done = {}, 0.0, 0
        for begin, length in _sequences_of(first, samples, self.opened["sequence"] or first + samples):
            more, more_seconds = self._render_once(
                first=begin,
                samples=length,
                user_passes=user_passes and not done,
                vectors=vectors and not done,
                **job,
            )
            done += length
            for name, values in more.items():
                if done > length:
                    values = channels[name] + (
                        values if _is_time(name) else (values - channels[name]) * (length / done)
                    )
                channels[name] = values
            seconds += more_seconds
        return channels, seconds

    def _render_once(self, **job):
        """Renders a pass of one sequence. If the last process died, a new one opens the scene again."""
        if not self.session.running:
            self._open()
        raw, seconds = self.session.render(**job)
        channels = exr.read(raw)
        self.attributes.update(exr.metadata(raw, CRYPTOMATTE))
        raw.unlink()
        return channels, seconds

    def _write(self, target, channels, counts, keep_all=False):
        layer = self.opened["view_layer"]
        time = next((values for name, values in channels.items() if _is_time(name)), None)
        part = {
            name: values
            for name, values in channels.items()
            if (keep_all and not _is_time(name)) or _layer_of(name) in PART_LAYERS or _layer_of(name) == VECTORS
        }
        part[f"{layer}.{SAMPLE_COUNT}"] = counts
        if time is not None:
            part[f"{layer}.{RENDER_SECONDS}"] = 1e-3 * time
        self.inputs.check()
        # It is read again soon, by every merge.
        exr.write(target, part, self.attributes if keep_all else None, compression="none")


def _sequences_of(first, samples, length):
    """Divides samples at the borders of sequences of this length: yields (first, samples)."""
    end = first + samples
    while first < end:
        following = min(end, (first // length + 1) * length)
        yield first, following - first
        first = following


def _is_time(name):
    return _layer_of(name) == RENDER_TIME


def _layer_of(name):
    """The pass of a channel ViewLayer.Pass.X, without the view layer."""
    return name.split(".")[-2]


def _effect_text(value):
    return value if not isinstance(value, bool) else "yes" if value else "no"
