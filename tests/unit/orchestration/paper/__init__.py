"""Tests of the paper's figures and claims, and of their measurement."""
