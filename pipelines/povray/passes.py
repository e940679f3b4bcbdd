"""Feature passes out of a renderer that has none: renders of the user's scene at low quality and with lamps of ours.

POV-Ray's quality levels: +Q1 shows plain surface colours; +Q3 adds direct light without shadows, reflections or surface
perturbation; +Q5 adds shadows; only +Q9 has fog. With S(...) the light that a surface sends back at +Q3, c its colour
times its diffuse share, N its normal (turned to the viewer):

  albedo      the +Q1 render.
  visibility  S at +Q5 over S at +Q3.
  normal      A parallel shadowless lamp from direction D adds c max(0, N.D). Lamps from all six axes at once add
              c (|Nx| + |Ny| + |Nz|); doubling +x and leaving out -x adds c Nx to that. So four renders give c N.
  depth       either: a shadowless lamp at the camera adds c N.V, and 2 / (1 + (z/d)^2) of it with `fade_distance d
              fade_power 2`: the ratio gives the distance z. Or: a fog of distance d and a brightness C that drowns the
              scene gives C (1 - exp(-z/d)); it needs no place of the camera and sees glass and mirrors too, but a +Q9
              render, and a camera that is not inside of a solid object.

All of this is linear only where POV-Ray computes, so images are taken back to its working gamma first.
"""

import dataclasses
import re
from typing import Optional

import numpy as np

from .scene import Shot
from .subpixels import Estimate, estimate

PROBE_SIDE = 64  # pixels of the longer side of the small renders that decide which passes are worth having
HALF_MAX = 65504.0  # POV-Ray writes half floats
HALF_STEP = 2.0**-11  # and rounds to these, relative
AXES = ("x", "y", "z")
LAMP = 2.0  # brightness of our lamps: above the scene's, but focal blur takes more rays where the image is brighter
SURFACES = ("+Q3",)
PLAIN = ("", SURFACES)
FLAT = "global_settings { max_trace_level 1 }"  # no reflections, nothing seen through glass

SEEN_SHARE = 0.02  # a pass that answers in fewer pixels than this is not worth its renders
DIFFUSE_RESIDUAL = 0.1  # relative departure from c N.D at which the lamps do not measure normals
DEPTH_RESIDUAL = 0.03  # relative disagreement of lamp and fog at which the camera is elsewhere
MOST_CAMERAS = 3  # of a scene file that are tried
AFTER_LOCATION = "(?:up|right|direction|sky|look_at|angle|aperture|blur_samples|focal_point|confidence|variance|perspective|orthographic)"
SHADOW = 0.02  # light that a shadow has to take to count as one


@dataclasses.dataclass
class Decision:
    """What the report says of one pass."""

    effect: str
    run: bool
    reason: str


@dataclasses.dataclass
class DepthTrick:
    """How depth is made: a lamp at `place`, or fog where place is None; d in scene units; what lies beyond `far`, or
    does not answer, is put there."""

    place: Optional[str]
    d: float
    far: float = np.inf


@dataclasses.dataclass
class Plan:
    """Which passes a frame calls for, and with what numbers."""

    gamma: float = 1.0
    albedo: bool = False
    normal: bool = False
    visibility: bool = False
    depth: Optional[DepthTrick] = None
    decisions: list[Decision] = dataclasses.field(default_factory=list)

    def decide(self, effect, run, reason):
        self.decisions.append(Decision(effect, run, reason))
        return run


class Lamps:
    """Renders of one scene at one size, in POV-Ray's working gamma."""

    def __init__(self, scene, gamma=1.0, scale=1, size=None, crop=None):
        self._scene, self._where, self.gamma = scene, dict(scale=scale, size=size, crop=crop), gamma
        self._kept = {}  # the plain render, which several passes share

    def images(self, *wanted):
        """Images (height, width, 3) in the working gamma; each is wanted as (scene text, options)."""
        missing = [key for key in dict.fromkeys(wanted) if key not in self._kept]
        shots = [Shot(tail=tail, options=options, **self._where) for tail, options in missing]
        found = dict(self._kept)
        for key, linear in zip(missing, self._scene.render_all(shots)):
            found[key] = np.maximum(linear, 0) ** (1 / self.gamma) if self.gamma != 1 else linear
            if key == PLAIN:
                self._kept[key] = found[key]
        return [found[key] for key in wanted]

    def sums(self, *wanted):
        """The same summed over the channels, (height, width), float64."""
        return [image.sum(-1, dtype=np.float64) for image in self.images(*wanted)]

    def axes(self, doubled=None, brightness=LAMP):
        """What to ask of images(): all six lamps on; of the pair along the axis `doubled` the positive one twice, the negative one not."""
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
    """(height, width, 3), linear: the factor of the beauty that it is."""
    return lamps.images(("", ("+Q1",)))[0] ** lamps.gamma


def visibility(lamps):
    """(height, width, 1), 0 to 1: 1 where nothing is lit."""
    open_light, light = lamps.sums(PLAIN, ("", ("+Q5",)))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(open_light > 1e-4, np.clip(light / open_light, 0, 1), 1.0)[..., None]


def normal(lamps):
    """Unit normals (height, width, 3), 0 where no diffuse surface answers; and how far, relative, the lamps together are
    from what these normals say (the diffuse model's residual)."""
    plain, together, *doubled = lamps.sums(PLAIN, lamps.axes(), *(lamps.axes(axis) for axis in AXES))
    vector = np.stack(doubled, -1) - together[..., None]
    length = np.linalg.norm(vector, axis=-1)
    seen = length > 8 * HALF_STEP * together
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = np.where(seen[..., None], vector / length[..., None], 0.0)
        residual = np.abs(together - plain - np.abs(vector).sum(-1)) / (together - plain)
    return unit, residual[seen]


def depth(lamps, trick):
    """Distance from the camera in scene units (height, width, 1), `far` at most; and where it was really measured."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if trick.place is None:
            white = (HALF_MAX * 0.9) ** (1 / lamps.gamma)
            fog = f"{FLAT} fog {{ fog_type 1 distance {trick.d:.9g} color rgb {white:.6g} }}"
            share = lamps.images((fog, ("+Q9",)))[0].min(-1).astype(np.float64) / white
            seen = share < 1 - 8 * HALF_STEP
            z = -trick.d * np.log1p(-share)
        else:
            lamp = f"light_source {{ {trick.place} color rgb {6 * LAMP:.6g} shadowless %s }}"
            fade = f"fade_distance {trick.d:.9g} fade_power 2"
            plain, steady, fading = lamps.sums(PLAIN, (lamp % "", SURFACES), (lamp % fade, SURFACES))
            fading = fading - plain
            seen = (steady - plain > 8 * HALF_STEP * steady) & (fading > 8 * HALF_STEP * plain)
            z = trick.d * np.sqrt(np.maximum(2 * (steady - plain) / fading - 1, 0))
    seen &= np.isfinite(z)
    return np.where(seen, np.minimum(z, trick.far), trick.far)[..., None], seen


def make_plan(scene, camera=None):
    """Looks at the scene in small renders and decides what it calls for; `camera` is its place, "x,y,z", if the user
    gave it."""
    longer = max(scene.width, scene.height)
    size = tuple(max(1, round(side * min(1, PROBE_SIDE / longer))) for side in (scene.width, scene.height))
    plan = Plan()
    plan.gamma = _working_gamma(Lamps(scene, size=size))
    lamps = Lamps(scene, plan.gamma, size=size)

    colours = albedo(lamps)
    spread = float(np.ptp(colours.reshape(-1, 3), axis=0).max())
    plan.albedo = plan.decide(
        "albedo", spread > 1e-3, f"surface colours differ by {spread:.2g}" if spread > 1e-3 else "one colour all over"
    )
    share = float((visibility(lamps) < 1 - SHADOW).mean())
    plan.visibility = plan.decide("visibility", share > SEEN_SHARE, f"{share:.0%} of the pixels lie in shadow")
    _plan_normal(lamps, plan)
    _plan_depth(scene, lamps, plan, camera)
    return plan


def render_features(scene, plan, scale, crop=None):
    """The passes of a plan, from scale x scale subpixels: {layer: Estimate}."""
    lamps = Lamps(scene, plan.gamma, scale=scale, crop=crop)
    found: dict[str, Estimate] = {}
    if plan.albedo:
        found["Denoising Albedo"] = estimate(albedo(lamps), scale)
    if plan.visibility:
        found["Visibility"] = estimate(visibility(lamps), scale)
    if plan.normal:
        found["Denoising Normal"] = estimate(normal(lamps)[0], scale)
    if plan.depth:
        found["Denoising Depth"] = estimate(depth(lamps, plan.depth)[0], scale)
    return found


def _working_gamma(lamps):
    """The exponent between POV-Ray's working values and linear ones (`assumed_gamma`, which a scene can set anywhere),
    measured: lamps four times as bright must add four times as much."""
    plain, dim, bright = lamps.images(PLAIN, lamps.axes(), lamps.axes(brightness=4 * LAMP))
    lit = dim > 2 * np.maximum(plain, 0.05)
    if lit.mean() < SEEN_SHARE:
        return 1.0

    def excess(gamma):
        low, middle, high = (np.maximum(image[lit], 0.0) ** (1 / gamma) for image in (plain, dim, bright))
        return float(np.median((high - low) / (middle - low)) - 4)

    return min(np.arange(1.0, 3.01, 0.02).round(2).tolist(), key=lambda gamma: abs(excess(gamma)))


def _plan_normal(lamps, plan):
    unit, residual = normal(lamps)
    share = float((np.abs(unit).max(-1) > 0).mean())
    error = float(np.median(residual)) if residual.size else np.inf
    if share < SEEN_SHARE:
        plan.decide("normal", False, f"only {share:.1%} of the pixels show a diffuse surface that our lamps reach")
    elif error > DIFFUSE_RESIDUAL:
        plan.decide("normal", False, f"surfaces do not answer lamps like diffuse ones (residual {error:.0%})")
    else:
        plan.normal = plan.decide("normal", True, f"surfaces in {share:.0%} of the pixels answer our lamps")


def _plan_depth(scene, lamps, plan, camera):
    """Tries both tricks. The lamp is cheaper, the fog sees more and needs no place: the lamp is taken where it agrees
    with the fog and sees as much."""
    places = camera_places(scene, camera)
    fog = _scaled(lamps, DepthTrick(None, 10.0))
    lamp = None
    for place in places:
        lamp = _scaled(lamps, DepthTrick(place, fog.trick.d if fog else 10.0))
        both = lamp.seen & fog.seen if lamp and fog else np.zeros(1, bool)
        error = float(np.median(np.abs(lamp.z[both] / fog.z[both] - 1))) if both.any() else 0.0
        if error <= DEPTH_RESIDUAL:
            break
        plan.decide("depth by lamp", False, f"the camera is not at {place} (distances are off by {error:.0%})")
        lamp = None
    if lamp and fog and (fog.seen & ~lamp.seen).mean() > SEEN_SHARE:
        plan.decide("depth by lamp", False, "glass, mirrors or unlit surfaces do not answer it, fog sees them")
        lamp = None
    chosen = lamp or fog
    if not chosen:
        plan.decide("depth", False, f"{'' if places else 'no place of the camera found, and '}the fog shows nothing")
    elif chosen is lamp:
        checked = "agrees with fog" if fog else "not checked: fog shows nothing"
        plan.depth = plan.decide("depth", True, f"by a fading lamp at {lamp.trick.place} ({checked})") and lamp.trick
    else:
        plan.depth = plan.decide("depth", True, "by fog") and fog.trick


@dataclasses.dataclass
class _Measured:
    trick: DepthTrick
    z: np.ndarray
    seen: np.ndarray


def _scaled(lamps, trick):
    """The trick with its d near the scene's depths and with its `far`, as measured; None where it shows nothing."""
    for _ in range(6):
        z, seen = (plane.squeeze() for plane in depth(lamps, trick))
        seen = seen & (z > trick.d * 16 * HALF_STEP)
        if seen.mean() < SEEN_SHARE:  # all too near, or all too far?
            far = not np.any(np.isfinite(z) & (z <= trick.d))
            trick = dataclasses.replace(trick, d=trick.d * (100 if far else 0.01))
            continue
        middle = float(np.median(z[seen]))
        if 0.3 < middle / trick.d < 3:
            trick.far = 2 * float(np.quantile(z[seen], 0.999))
            return _Measured(trick, z, seen)
        trick = dataclasses.replace(trick, d=middle)
    return None


def camera_places(scene, given=None):
    """Where the camera may be, texts "<x,y,z>": as given, or what the scene file's cameras, last one first, say after
    `location`, as POV-Ray itself evaluates it at the end of the scene. Empty where that does not work: the camera stands
    in another file, is moved by transformations, or its words no longer mean anything there."""
    if given:
        return [f"<{given}>"]
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", scene.path.read_text(errors="replace"), flags=re.DOTALL)
    cameras = [_braces(text, found.end()) for found in re.finditer(r"\bcamera\s*\{", text)]
    places = []
    for camera in cameras[::-1][:MOST_CAMERAS]:
        found = re.search(rf"\blocation\b(.*?)(?=\b{AFTER_LOCATION}\b|\#|$)", camera, re.DOTALL)
        if not found or re.search(r"\b(translate|rotate|scale|matrix|transform)\b", camera):
            continue
        marker = "polyrecon camera:"
        tail = f'#debug concat("\\n{marker}", vstr(3, <0,0,0> + ({found[1].strip()}), ",", 0, 9), "\\n")'
        places += [f"<{printed}>" for printed in scene.debug(tail, marker)[-1:]]
    return places


def _braces(text, start):
    """The text from `start` to the brace that closes it."""
    level = 1
    for at in range(start, len(text)):
        level += {"{": 1, "}": -1}.get(text[at], 0)
        if level == 0:
            return text[start:at]
    return text[start:]
