"""Drivers that make renderers and polyrecon work together; installed as the package `polyrecon_pipelines`."""
