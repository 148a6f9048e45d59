"""Experiments with the binary of an FMU, which run in a process of their own."""
