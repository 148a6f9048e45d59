"""Stability of a co-simulation at a communication step, and the largest stable step."""
