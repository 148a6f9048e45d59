"""Tests of the description of coupled systems."""
