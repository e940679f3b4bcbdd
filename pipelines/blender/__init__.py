"""Drivers of Blender's Cycles: see README.md."""
