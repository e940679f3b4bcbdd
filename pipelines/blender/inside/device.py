"""What Cycles renders on: the processor, or graphics cards (runs inside Blender).

Blender starts with factory settings, in which no card is switched on."""

import bpy

CARDS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")  # Cycles' words; the first that the machine has is used


def choose(scene, wanted):
    """Sets up the device and returns its type, "CPU" or one of CARDS.

    wanted: "cpu", "gpu", or "auto": a graphics card if the scene renders on the GPU and there is one."""
    if wanted == "gpu" or (wanted == "auto" and scene.cycles.device == "GPU"):
        cycles = bpy.context.preferences.addons["cycles"].preferences
        for kind in CARDS:
            if switch_on(cycles, kind):
                scene.cycles.device = "GPU"
                return kind
        cycles.compute_device_type = "NONE"
        if wanted == "gpu":
            raise RuntimeError("--device gpu: Cycles finds no graphics card; use --device cpu")
    scene.cycles.device = "CPU"
    return "CPU"


def switch_on(cycles, kind):
    """Switches on all devices of a type and no others; returns whether there is one. cycles: Cycles' preferences."""
    try:
        cycles.compute_device_type = kind
    except TypeError:  # This Blender was built without it.
        return False
    if hasattr(cycles, "refresh_devices"):  # Blender 3.6 and later
        cycles.refresh_devices()
    else:
        cycles.get_devices()
    for found in cycles.devices:
        found.use = found.type == kind
    return any(found.use for found in cycles.devices)
