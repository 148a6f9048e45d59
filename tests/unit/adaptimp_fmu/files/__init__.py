"""Tests of the package `adaptimp_fmu.files`, one module at a time."""
