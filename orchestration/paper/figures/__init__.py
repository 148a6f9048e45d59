"""Draws the figures of Lu & Meng (1991), with the panels that their captions name.

Every window, limit and mark is computed from the runs, so the figures fit any calibration. Figures that a reader
compares have the same axes: Figs. 2 and 4, and Figs. 5 to 7.
"""
