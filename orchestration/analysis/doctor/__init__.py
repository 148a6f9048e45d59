"""Examines whether a co-simulation is right: stability, accuracy, energy, delays, and what other tools would lose."""
