"""Frames over machines, by engines that exist: Slurm and Open Job Description."""
