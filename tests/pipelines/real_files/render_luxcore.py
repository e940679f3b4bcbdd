"""Renders a triangle on a floor with LuxCore, a file for each pass:

    render_luxcore.py OUT_PREFIX SEED [--size WxH] [--spp N] [--lamp] [--importance MAP.npy]

--lamp: a small lamp lights it, and hardly anything else. --importance: samples follow this map of floats, (H, W), the
upper row first."""

import argparse
import os
import sys
import time

import numpy as np
import pyluxcore

OUTPUTS = [
    "RGB_IMAGEPIPELINE",
    "RGBA_IMAGEPIPELINE",
    "RGB",
    "ALBEDO",
    "AVG_SHADING_NORMAL",
    "SHADING_NORMAL",
    "DEPTH",
    "SAMPLECOUNT",
    "ALPHA",
    "POSITION",
    "DIRECT_DIFFUSE",
]
# With these the Sobol sampler chooses pixels by the map alone, which it has only where the film has NOISE, too. That is
# first estimated after a million samples per pixel, which is never.
BY_IMPORTANCE = {
    "sampler.sobol.adaptive.strength": 0.99,
    "sampler.sobol.adaptive.userimportanceweight": 1,
    "film.noiseestimation.warmup": 1_000_000,
}

parser = argparse.ArgumentParser()
parser.add_argument("prefix")
parser.add_argument("seed", type=int)
parser.add_argument("--size", default="32x24")
parser.add_argument("--spp", type=int, default=8)
parser.add_argument("--lamp", action="store_true")
parser.add_argument("--importance")
given = parser.parse_args()
width, height = map(int, given.size.split("x"))

pyluxcore.Init(lambda message: None)
settings = {
    "renderengine.type": "PATHCPU",
    "renderengine.seed": given.seed,
    "sampler.type": "SOBOL",
    "native.threads.count": 1,
    "film.width": width,
    "film.height": height,
    "film.filter.type": "NONE",
    "film.imagepipelines.0.0.type": "NOP",
    "batch.haltspp": given.spp,
    "film.safesave": 0,
    **(BY_IMPORTANCE if given.importance else {}),
}
for i, output in enumerate(OUTPUTS + (["USER_IMPORTANCE", "NOISE"] if given.importance else [])):
    settings[f"film.outputs.{i}.type"] = output
    settings[f"film.outputs.{i}.filename"] = f"{given.prefix}{output}.exr"
objects = {
    "scene.camera.type": "perspective",
    "scene.camera.lookat.orig": "0 -5 1",
    "scene.camera.lookat.target": "0 0 0",
    "scene.camera.fieldofview": 40,
    "scene.lights.sky.type": "constantinfinite",
    "scene.lights.sky.color": "0.02 0.03 0.05" if given.lamp else "0.2 0.3 0.5",
    "scene.materials.red.type": "matte",
    "scene.materials.red.kd": "0.8 0.3 0.2",
    "scene.materials.grey.type": "matte",
    "scene.materials.grey.kd": "0.6 0.6 0.6",
    "scene.shapes.triangle.type": "inlinedmesh",
    "scene.shapes.triangle.vertices": "-0.5 0 -0.9 0.5 0 -0.9 0 0 0.4",
    "scene.shapes.triangle.faces": "0 1 2",
    "scene.shapes.floor.type": "inlinedmesh",
    "scene.shapes.floor.vertices": "-5 -5 -1 5 -5 -1 5 5 -1 -5 5 -1",
    "scene.shapes.floor.faces": "0 1 2 2 3 0",
    "scene.objects.a.shape": "triangle",
    "scene.objects.a.material": "red",
    "scene.objects.b.shape": "floor",
    "scene.objects.b.material": "grey",
}
if given.lamp:
    objects |= {
        "scene.materials.lamp.type": "matte",
        "scene.materials.lamp.emission": "60 50 40",
        "scene.shapes.lamp.type": "inlinedmesh",
        "scene.shapes.lamp.vertices": "1.2 0.3 -0.2 1.35 0.3 -0.2 1.35 0.45 -0.2 1.2 0.45 -0.2",
        "scene.shapes.lamp.faces": "0 2 1 0 3 2",
        "scene.objects.c.shape": "lamp",
        "scene.objects.c.material": "lamp",
    }


def properties(values):
    made = pyluxcore.Properties()
    made.SetFromString("".join(f"{key} = {value}\n" for key, value in values.items()))
    return made


scene = pyluxcore.Scene()
scene.Parse(properties(objects))
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(settings), scene))
session.Start()
if given.importance:
    upwards = np.ascontiguousarray(np.load(given.importance)[::-1], np.float32)  # a film's rows begin at the bottom
    session.GetFilm().UpdateOutputFloat(pyluxcore.FilmOutputType.USER_IMPORTANCE, upwards)
while not session.HasDone():
    time.sleep(0.01)
    session.UpdateStats()
session.Stop()
session.GetFilm().SaveOutputs()
sys.stdout.flush()
os._exit(0)  # the module's own end fails
