"""Formulas of measures in C and in numpy."""
