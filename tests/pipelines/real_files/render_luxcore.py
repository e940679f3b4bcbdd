"""Renders a triangle on a floor with LuxCore, a file for each pass: render_luxcore.py OUT_PREFIX SEED"""

import os
import sys
import time

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

prefix, seed = sys.argv[1:]
pyluxcore.Init(lambda message: None)
settings = {
    "renderengine.type": "PATHCPU",
    "renderengine.seed": seed,
    "sampler.type": "SOBOL",
    "native.threads.count": 1,
    "film.width": 32,
    "film.height": 24,
    "film.filter.type": "NONE",
    "film.imagepipelines.0.0.type": "NOP",
    "batch.haltspp": 8,
    "film.safesave": 0,
}
for i, output in enumerate(OUTPUTS):
    settings[f"film.outputs.{i}.type"] = output
    settings[f"film.outputs.{i}.filename"] = f"{prefix}{output}.exr"
objects = {
    "scene.camera.type": "perspective",
    "scene.camera.lookat.orig": "0 -5 1",
    "scene.camera.lookat.target": "0 0 0",
    "scene.camera.fieldofview": 40,
    "scene.lights.sky.type": "constantinfinite",
    "scene.lights.sky.color": "0.2 0.3 0.5",
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


def properties(values):
    made = pyluxcore.Properties()
    made.SetFromString("".join(f"{key} = {value}\n" for key, value in values.items()))
    return made


scene = pyluxcore.Scene()
scene.Parse(properties(objects))
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(settings), scene))
session.Start()
while not session.HasDone():
    time.sleep(0.01)
    session.UpdateStats()
session.Stop()
session.GetFilm().SaveOutputs()
sys.stdout.flush()
os._exit(0)  # the module's own end fails
