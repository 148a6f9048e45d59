"""Tests of the order of numerical methods, on problems with an independent solution."""
