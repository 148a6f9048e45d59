"""Tests of the check of FMU files."""
