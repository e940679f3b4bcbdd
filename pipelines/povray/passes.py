"""Feature passes of POV-Ray, which has none: renders of the user's scene at low quality and with added lamps.

POV-Ray's quality levels: +Q1 shows plain surface colours; +Q3 adds direct light without shadows, reflections or surface
perturbation; +Q5 adds shadows; only +Q9 has fog. c is a surface's colour times its diffuse share, N its normal (turned
to the viewer), V the direction to the viewer:

  albedo      The +Q1 render.
  visibility  The +Q5 render divided by the +Q3 render.
  normal      At +Q3 a parallel shadowless lamp from direction D adds c max(0, N.D). Lamps from all six directions of
              the axes together add c (|Nx| + |Ny| + |Nz|). With twice the lamp at +x and none at -x they add c Nx more.
              So four renders give c N.
  depth       By a lamp: at +Q3 a shadowless lamp at the camera adds c N.V, and with `fade_distance d fade_power 2` it
              adds 2 / (1 + (z/d)^2) of that. The ratio gives the distance z.
              By fog: a fog of distance d, so bright (C) that the scene vanishes in it, gives C (1 - exp(-z/d)). It
              needs no place of the camera, and glass and mirrors have a depth. But it takes a +Q9 render, and the
              camera must not be inside a solid object.

These sums hold in POV-Ray's working gamma, so images are converted to it first.
"""

import dataclasses
import re
from typing import Optional

import numpy as np

from .scene import Shot
from .subpixels import Estimate, estimate

PROBE_SIDE = 64  # pixels of the longer side of the small renders by which passes are chosen
HALF_MAX = 65504.0  # largest half float, in which POV-Ray writes images
HALF_STEP = 2.0**-11  # relative rounding error of half floats
AXES = ("x", "y", "z")
# Brightness of the added lamps. It exceeds that of the scene's lamps; more would make focal blur take more rays.
LAMP = 2.0
SURFACES = ("+Q3",)
PLAIN = ("", SURFACES)
FLAT = "global_settings { max_trace_level 1 }"  # no reflections and no refraction

MIN_SHARE = 0.02  # a pass that has values in a smaller share of the pixels is not rendered
DIFFUSE_RESIDUAL = 0.1  # relative deviation from c N.D above which the lamps do not measure normals
DEPTH_RESIDUAL = 0.03  # relative difference of lamp and fog above which the camera is elsewhere
MAX_CAMERAS = 3  # cameras of a scene file that are tried
AFTER_LOCATION = (
    "(?:up|right|direction|sky|look_at|angle|aperture|blur_samples|focal_point|confidence|variance|perspective"
    "|orthographic)"
)
SHADOW = 0.02  # share of the light that a pixel in shadow lacks at least


@dataclasses.dataclass
class Decision:
    """Whether a pass is rendered, and why."""

    name: str
    run: bool
    reason: str


@dataclasses.dataclass
class DepthMethod:
    """Depth by a lamp at the camera, or by fog."""

    place: Optional[str]  # of the camera and the lamp; None: fog
    d: float  # distance of the lamp's fading or of the fog, in scene units
    far: float = np.inf  # depth of what is further away, or was not measured


@dataclasses.dataclass
class PassChoice:
    """The passes of a frame and their parameters."""

    gamma: float = 1.0
    albedo: bool = False
    normal: bool = False
    visibility: bool = False
    depth: Optional[DepthMethod] = None
    decisions: list[Decision] = dataclasses.field(default_factory=list)

    def decide(self, name, run, reason):
        self.decisions.append(Decision(name, run, reason))
        return run


class Lamps:
    """Renders of one scene at one size, in POV-Ray's working gamma."""

    def __init__(self, scene, gamma=1.0, scale=1, size=None, crop=None):
        self._scene, self.gamma = scene, gamma
        self._frame = {"scale": scale, "size": size, "crop": crop}
        self._kept = {}  # the plain render, which several passes use

    def images(self, *wanted):
        """Renders images (height, width, 3) in the working gamma. Each is wanted as (scene text, options)."""
        missing = [key for key in dict.fromkeys(wanted) if key not in self._kept]
        shots = [Shot(tail=tail, options=options, **self._frame) for tail, options in missing]
        found = dict(self._kept)
        for key, linear in zip(missing, self._scene.render_all(shots)):
            found[key] = np.maximum(linear, 0) ** (1 / self.gamma) if self.gamma != 1 else linear
            if key == PLAIN:
                self._kept[key] = found[key]
        return [found[key] for key in wanted]

    def sums(self, *wanted):
        """The same images, summed over the channels: float64 (height, width)."""
        return [image.sum(-1, dtype=np.float64) for image in self.images(*wanted)]

    def axes(self, doubled=None, brightness=LAMP):
        """The (scene text, options) of an image with all six lamps. On the axis `doubled`, the positive lamp has twice
        the brightness and the negative one none."""
        lamps = []
        for axis in AXES:
            for sign in (1, -1):
                times = 1 if axis != doubled else 1 + sign
                lamps.append(
                    f"light_source {{ {sign}e4*{axis} color rgb {times * brightness:.6g}"
                    " parallel point_at <0,0,0> shadowless }"
                )
        return "\n".join(lamps), SURFACES


def albedo(lamps):
    """Surface colours, linear: (height, width, 3)."""
    return lamps.images(("", ("+Q1",)))[0] ** lamps.gamma


def visibility(lamps):
    """The share of direct light that reaches a pixel, 0 to 1: (height, width, 1). It is 1 where there is no light."""
    open_light, light = lamps.sums(PLAIN, ("", ("+Q5",)))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(open_light > 1e-4, np.clip(light / open_light, 0, 1), 1.0)[..., None]


def normal(lamps):
    """(unit normals, residuals). The normals are (height, width, 3), and 0 where no diffuse surface reflects the lamps.
    The residuals are the relative deviations of all lamps together from the diffuse model, for pixels that have a
    normal."""
    plain, together, *doubled = lamps.sums(PLAIN, lamps.axes(), *(lamps.axes(axis) for axis in AXES))
    vector = np.stack(doubled, -1) - together[..., None]
    length = np.linalg.norm(vector, axis=-1)
    measured = length > 8 * HALF_STEP * together
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = np.where(measured[..., None], vector / length[..., None], 0.0)
        residual = np.abs(together - plain - np.abs(vector).sum(-1)) / (together - plain)
    return unit, residual[measured]


def depth(lamps, method):
    """(distances, measured): distances from the camera in scene units (height, width, 1), at most method.far, and the
    pixels where they were measured."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if method.place is None:
            white = (HALF_MAX * 0.9) ** (1 / lamps.gamma)
            fog = f"{FLAT} fog {{ fog_type 1 distance {method.d:.9g} color rgb {white:.6g} }}"
            share = lamps.images((fog, ("+Q9",)))[0].min(-1).astype(np.float64) / white
            measured = share < 1 - 8 * HALF_STEP
            z = -method.d * np.log1p(-share)
        else:
            lamp = f"light_source {{ {method.place} color rgb {6 * LAMP:.6g} shadowless %s }}"
            fade = f"fade_distance {method.d:.9g} fade_power 2"
            plain, steady, fading = lamps.sums(PLAIN, (lamp % "", SURFACES), (lamp % fade, SURFACES))
            fading = fading - plain
            measured = (steady - plain > 8 * HALF_STEP * steady) & (fading > 8 * HALF_STEP * plain)
            z = method.d * np.sqrt(np.maximum(2 * (steady - plain) / fading - 1, 0))
    measured &= np.isfinite(z)
    return np.where(measured, np.minimum(z, method.far), method.far)[..., None], measured


def choose_passes(scene, camera=None):
    """Decides by small renders of the scene which passes it needs; returns a PassChoice.

    camera: the place of the camera, "x,y,z", if the user gave it."""
    longer = max(scene.width, scene.height)
    size = tuple(max(1, round(side * min(1, PROBE_SIDE / longer))) for side in (scene.width, scene.height))
    choice = PassChoice()
    choice.gamma = _working_gamma(Lamps(scene, size=size))
    lamps = Lamps(scene, choice.gamma, size=size)

    colours = albedo(lamps)
    spread = float(np.ptp(colours.reshape(-1, 3), axis=0).max())
    choice.albedo = choice.decide(
        "albedo",
        spread > 1e-3,
        f"surface colours differ by {spread:.2g}" if spread > 1e-3 else "all surfaces have one colour",
    )
    share = float((visibility(lamps) < 1 - SHADOW).mean())
    choice.visibility = choice.decide("visibility", share > MIN_SHARE, f"{share:.0%} of the pixels lie in shadow")
    _choose_normal(lamps, choice)
    _choose_depth(scene, lamps, choice, camera)
    return choice


def render_features(scene, choice, scale, crop=None):
    """The chosen passes, from scale x scale subpixels: {layer: Estimate}."""
    lamps = Lamps(scene, choice.gamma, scale=scale, crop=crop)
    found: dict[str, Estimate] = {}
    if choice.albedo:
        found["Denoising Albedo"] = estimate(albedo(lamps), scale)
    if choice.visibility:
        found["Visibility"] = estimate(visibility(lamps), scale)
    if choice.normal:
        found["Denoising Normal"] = estimate(normal(lamps)[0], scale)
    if choice.depth:
        found["Denoising Depth"] = estimate(depth(lamps, choice.depth)[0], scale)
    return found


def _working_gamma(lamps):
    """The exponent from POV-Ray's working values to linear ones (`assumed_gamma`). A scene can set it anywhere, so it
    is measured: lamps that are four times as bright must add four times as much."""
    plain, dim, bright = lamps.images(PLAIN, lamps.axes(), lamps.axes(brightness=4 * LAMP))
    lit = dim > 2 * np.maximum(plain, 0.05)
    if lit.mean() < MIN_SHARE:
        return 1.0

    def excess(gamma):
        low, middle, high = (np.maximum(image[lit], 0.0) ** (1 / gamma) for image in (plain, dim, bright))
        return float(np.median((high - low) / (middle - low)) - 4)

    return min(np.arange(1.0, 3.01, 0.02).round(2).tolist(), key=lambda gamma: abs(excess(gamma)))


def _choose_normal(lamps, choice):
    unit, residual = normal(lamps)
    share = float((np.abs(unit).max(-1) > 0).mean())
    error = float(np.median(residual)) if residual.size else np.inf
    if share < MIN_SHARE:
        choice.decide("normal", False, f"only {share:.1%} of the pixels show a diffuse surface that added lamps light")
    elif error > DIFFUSE_RESIDUAL:
        choice.decide("normal", False, f"surfaces do not reflect lamps as diffuse ones do (residual {error:.0%})")
    else:
        choice.normal = choice.decide("normal", True, f"surfaces in {share:.0%} of the pixels reflect added lamps")


def _choose_depth(scene, lamps, choice, camera):
    """Tries both methods. Fog measures more pixels and needs no place of the camera, but the lamp takes less time. The
    lamp is chosen if it agrees with the fog and measures as many pixels."""
    places = camera_places(scene, camera)
    fog = _scaled(lamps, DepthMethod(None, 10.0))
    lamp = None
    for place in places:
        lamp = _scaled(lamps, DepthMethod(place, fog.method.d if fog else 10.0))
        both = lamp.measured & fog.measured if lamp and fog else np.zeros(1, bool)
        error = float(np.median(np.abs(lamp.z[both] / fog.z[both] - 1))) if both.any() else 0.0
        if error <= DEPTH_RESIDUAL:
            break
        choice.decide("depth by lamp", False, f"the camera is not at {place} (distances are off by {error:.0%})")
        lamp = None
    if lamp and fog and (fog.measured & ~lamp.measured).mean() > MIN_SHARE:
        choice.decide("depth by lamp", False, "glass, mirrors or unlit surfaces do not reflect it, fog measures them")
        lamp = None
    chosen = lamp or fog
    if not chosen:
        choice.decide("depth", False, f"{'' if places else 'no place of the camera was found, and '}fog shows nothing")
    elif chosen is lamp:
        checked = "agrees with fog" if fog else "not checked: fog shows nothing"
        choice.depth = (
            choice.decide("depth", True, f"by a fading lamp at {lamp.method.place} ({checked})") and lamp.method
        )
    else:
        choice.depth = choice.decide("depth", True, "by fog") and fog.method


@dataclasses.dataclass
class _Measurement:
    method: DepthMethod
    z: np.ndarray
    measured: np.ndarray


def _scaled(lamps, method):
    """The measurement by the method with a d near the scene's depths, and its `far`; None if nothing is measured."""
    for _ in range(6):
        z, measured = (plane.squeeze() for plane in depth(lamps, method))
        measured = measured & (z > method.d * 16 * HALF_STEP)
        if measured.mean() < MIN_SHARE:  # The scene is either much nearer or much further away than d.
            far = not np.any(np.isfinite(z) & (z <= method.d))
            method = dataclasses.replace(method, d=method.d * (100 if far else 0.01))
            continue
        middle = float(np.median(z[measured]))
        if 0.3 < middle / method.d < 3:
            method.far = 2 * float(np.quantile(z[measured], 0.999))
            return _Measurement(method, z, measured)
        method = dataclasses.replace(method, d=middle)
    return None


def camera_places(scene, given=None):
    """Possible places of the camera, texts "<x,y,z>".

    Without a given one they are the `location` of the cameras in the scene file, the last one first, evaluated by
    POV-Ray at the end of the scene. There is none for a camera in another file, a transformed camera, and an expression
    that has no value at the end of the scene."""
    if given:
        return [f"<{given}>"]
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", scene.path.read_text(errors="replace"), flags=re.DOTALL)
    cameras = [_braces(text, found.end()) for found in re.finditer(r"\bcamera\s*\{", text)]
    places = []
    for camera in cameras[::-1][:MAX_CAMERAS]:
        found = re.search(rf"\blocation\b(.*?)(?=\b{AFTER_LOCATION}\b|\#|$)", camera, re.DOTALL)
        if not found or re.search(r"\b(translate|rotate|scale|matrix|transform)\b", camera):
            continue
        marker = "polyrecon camera:"
        tail = f'#debug concat("\\n{marker}", vstr(3, <0,0,0> + ({found[1].strip()}), ",", 0, 9), "\\n")'
        places += [f"<{printed}>" for printed in scene.debug(tail, marker)[-1:]]
    return places


def _braces(text, start):
    """The text from `start` to the closing brace."""
    level = 1
    for at in range(start, len(text)):
        level += {"{": 1, "}": -1}.get(text[at], 0)
        if level == 0:
            return text[start:at]
    return text[start:]
