"""Tests of stores of runs."""
