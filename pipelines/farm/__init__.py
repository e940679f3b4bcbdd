"""Distributes frames over machines, with Slurm or Open Job Description."""
