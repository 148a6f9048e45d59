"""Chooses the calibration: an objective over the sentences of Section V, a search, and what keeps the sentences."""
