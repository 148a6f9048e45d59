"""The robot of Lu & Meng (1991): its scenarios, its figures, and the claims of the paper, measured."""
