"""The folders that simulations of a file write to (runs inside Blender). The driver lets Blender write into its own
folder alone."""

import os

import bpy

FLUID_FOLDERS = ("config", "data", "guiding", "mesh", "noise", "particles")


def redirect(folder):
    """Makes simulations that are cached while frames are evaluated write below `folder`, or into memory. What their own
    cache holds is used. Baked simulations are only read, and stay where they are.

    Blender deletes a cache that moves into memory, which the driver does not allow."""
    for cache in _point_caches():
        if cache.use_disk_cache and not (cache.is_baked or cache.use_external):
            cache.use_disk_cache = False
    for number, (owner, settings) in enumerate(_fluid_domains()):
        if settings.cache_type == "REPLAY":
            own = os.path.join(folder, f"fluid_{number}")
            _link_files(bpy.path.abspath(settings.cache_directory, library=owner.library), own)
            settings.cache_directory = own


def _point_caches():
    for scene in bpy.data.scenes:
        if scene.rigidbody_world:
            yield scene.rigidbody_world.point_cache
    for owner in bpy.data.objects:
        yield from (system.point_cache for system in owner.particle_systems)
        for modifier in owner.modifiers:
            if modifier.type in ("CLOTH", "SOFT_BODY"):
                yield modifier.point_cache
            elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings:
                yield from (surface.point_cache for surface in modifier.canvas_settings.canvas_surfaces)


def _fluid_domains():
    for owner in bpy.data.objects:
        for modifier in owner.modifiers:
            if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings:
                yield owner, modifier.domain_settings


def _link_files(source, target):
    for name in FLUID_FOLDERS:
        os.makedirs(os.path.join(target, name))
        folder = os.path.join(source, name)
        for entry in os.scandir(folder) if os.path.isdir(folder) else ():
            if entry.is_file():
                os.symlink(os.path.abspath(entry.path), os.path.join(target, name, entry.name))
