"""Drawings for the FMUs' pages: the loop with one component marked, and what the variables of each component mean."""
