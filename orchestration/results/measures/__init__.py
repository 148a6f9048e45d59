"""Measures: numbers that a formula reads off a run, such as ``max(norm(plant.F_ext))``."""
