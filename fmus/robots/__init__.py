"""Robots in FMUs: the parameters that plants and controllers declare of them, and their start values."""
