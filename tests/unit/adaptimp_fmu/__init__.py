"""Tests of the package `adaptimp_fmu`, one module at a time."""
