"""Blender (Cycles) behind the interface of the loop: see README.md."""
