"""Experiments with the binary of an FMU, in a process of their own."""
